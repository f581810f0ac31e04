#include "imaging/invesalius_masks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "imaging/invesalius.h"
#include "imaging/invesalius_project.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

/// The lowest value that is selected.
constexpr std::uint8_t kSelected = 128;

/// What a user did to a voxel outlasts the threshold: 1 and 2 took it away, 253 and 254 added it.
bool isEdited(std::uint8_t value) {
  return value == 1 || value == 2 || value == 253 || value == 254;
}

std::string shapeText(const GridGeometry& geometry) {
  return std::to_string(geometry.dims[2] + 1) + ", " + std::to_string(geometry.dims[1] + 1) + ", " +
         std::to_string(geometry.dims[0] + 1);
}

Result<std::array<std::uint8_t, 3>> colourOf(const pugi::xml_node& dict, const fs::path& file,
                                             const std::string& part) {
  const auto shares = plistNumbers(plistValue(dict, "colour"));
  const bool fits = shares.size() >= 3 && std::all_of(shares.begin(), shares.end(), [](double s) {
                      return s >= 0.0 && s <= 1.0;
                    });
  if (!fits) {
    return fail(
        wrongPlistField(file, part, "colour", "another colour", "three numbers from 0 to 1"));
  }
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<std::uint8_t>(std::lround(shares[c] * 255.0));
  }
  return colour;
}

Result<InvesaliusMask> readMaskPlist(const fs::path& file, const std::string& part,
                                     const GridGeometry& geometry) {
  const auto document = readPlist(file, part);
  if (!document) return fail(document.error());
  const pugi::xml_node dict = document->child("plist").child("dict");
  InvesaliusMask mask;
  mask.name = plistValue(dict, "name").child_value();
  mask.voxelFile = fs::path(plistValue(dict, "mask_file").child_value()).filename().string();
  if (mask.voxelFile.empty()) {
    return fail(wrongPlistField(file, part, "mask_file", "", "the name of the mask's voxel file"));
  }
  const auto shape = plistNumbers(plistValue(dict, "mask_shape"));
  // One slice, row and column more than the voxels.
  const bool fits = shape.size() == 3 && shape[0] == geometry.dims[2] + 1.0 &&
                    shape[1] == geometry.dims[1] + 1.0 && shape[2] == geometry.dims[0] + 1.0;
  if (!fits) {
    return fail(wrongPlistField(file, part, "mask_shape", "another shape", shapeText(geometry)));
  }
  const auto range = plistNumbers(plistValue(dict, "threshold_range"));
  if (range.size() != 2 || !std::isfinite(range[0]) || !std::isfinite(range[1])) {
    return fail(wrongPlistField(file, part, "threshold_range", "another range",
                                "the lowest and the highest value"));
  }
  mask.threshold = {range[0], range[1]};
  const auto colour = colourOf(dict, file, part);
  if (!colour) return fail(colour.error());
  mask.colour = *colour;
  return mask;
}

/// The bytes of a mask with its border.
struct BorderedMask {
  const GridGeometry& geometry;
  std::vector<char> bytes;

  /// The byte at place (x, y, z) of the bordered grid, 0 being the border.
  [[nodiscard]] std::uint8_t at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const auto nx = static_cast<std::size_t>(geometry.dims[0]) + 1;
    const auto ny = static_cast<std::size_t>(geometry.dims[1]) + 1;
    const std::size_t place =
        (static_cast<std::size_t>(z) * ny + static_cast<std::size_t>(y)) * nx +
        static_cast<std::size_t>(x);
    return static_cast<std::uint8_t>(bytes[place]);
  }
  [[nodiscard]] bool isWorkedOut(std::int32_t z) const { return at(0, 0, z + 1) != 0; }
  [[nodiscard]] bool isWorkedOut() const {
    for (std::int32_t z = 0; z < geometry.dims[2]; ++z) {
      if (!isWorkedOut(z)) return false;
    }
    return true;
  }
};

}  // namespace

Result<std::vector<InvesaliusMask>> listInvesaliusMasks(const fs::path& file) {
  const auto project = openInvesaliusProject(file);
  if (!project) return fail(project.error());
  std::vector<InvesaliusMask> masks;
  for (const std::string& part : project->maskFiles) {
    auto mask = readMaskPlist(file, part, project->geometry);
    if (!mask) return fail(mask.error());
    masks.push_back(std::move(*mask));
  }
  return masks;
}

Result<LabelGrid> readInvesaliusMask(const fs::path& file, const InvesaliusMask& mask) {
  const auto project = openInvesaliusProject(file);
  if (!project) return fail(project.error());
  LabelGrid grid;
  grid.geometry = project->geometry;
  const auto& dims = grid.geometry.dims;
  std::uint64_t size = 1;
  for (const std::int32_t n : dims) size *= static_cast<std::uint64_t>(n) + 1;
  auto bytes = readExactly(file, mask.voxelFile, size, "voxels of a mask");
  if (!bytes) return fail(bytes.error());
  const BorderedMask bordered{grid.geometry, std::move(*bytes)};
  Volume volume;
  if (!bordered.isWorkedOut()) {
    auto scan = readInvesalius(file);
    if (!scan) return fail(scan.error());
    volume = std::move(scan->volume);
  }
  grid.labels.resize(grid.geometry.voxelCount());
  std::size_t voxel = 0;
  for (std::int32_t z = 0; z < dims[2]; ++z) {
    const bool workedOut = bordered.isWorkedOut(z);
    for (std::int32_t y = 0; y < dims[1]; ++y) {
      const std::int32_t row = invesaliusRow(grid.geometry, y) + 1;
      for (std::int32_t x = 0; x < dims[0]; ++x, ++voxel) {
        const std::uint8_t value = bordered.at(x + 1, row, z + 1);
        bool selected = value >= kSelected;
        if (!workedOut && !isEdited(value)) {
          const double grey = volume.value(voxel);
          selected = grey >= mask.threshold.low && grey <= mask.threshold.high;
        }
        grid.labels[voxel] = selected ? 1 : 0;
      }
    }
  }
  return grid;
}

}  // namespace palpate
