#include "imaging/invesalius.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <pugixml.hpp>

#include "imaging/archive.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMaxPlistBytes = 1U << 20U;  // real ones are below 10 kB
constexpr std::int32_t kMaxSide = 8192;

struct Project {
  GridGeometry geometry;
  std::string modality;
  std::string matrixFile;
};

Error wrongField(const fs::path& file, const char* field, std::string found, const char* wanted) {
  return inputRefused("The InVesalius project cannot be read.")
      .inFile(file.string())
      .inField(std::string("main.plist: ") + field)
      .butFound(found.empty() ? "nothing" : std::move(found))
      .wants(wanted)
      .advise("Open the project in InVesalius and save it again.");
}

/// The element after `<key>name</key>` in a plist dictionary; null when there is none.
pugi::xml_node valueOf(const pugi::xml_node& dict, const char* name) {
  for (const pugi::xml_node key : dict.children("key")) {
    if (std::strcmp(key.child_value(), name) == 0) return key.next_sibling();
  }
  return {};
}

std::vector<double> numbersOf(const pugi::xml_node& array) {
  std::vector<double> numbers;
  for (const pugi::xml_node item : array.children()) numbers.push_back(item.text().as_double());
  return numbers;
}

Result<Project> parseProject(const std::vector<char>& plist, const fs::path& file) {
  pugi::xml_document document;
  if (!document.load_buffer(plist.data(), plist.size())) {
    return fail(wrongField(file, "whole file", "text that is not XML", "an XML property list"));
  }
  const pugi::xml_node root = document.child("plist").child("dict");
  const pugi::xml_node matrix = valueOf(root, "matrix");
  Project project;
  project.modality = valueOf(root, "modality").child_value();
  if (project.modality == "MRI") project.modality = "MR";
  project.matrixFile = fs::path(valueOf(matrix, "filename").child_value()).filename().string();
  if (project.matrixFile.empty()) {
    return fail(wrongField(file, "matrix, filename", "", "the name of the voxel file"));
  }
  const std::string type = valueOf(matrix, "dtype").child_value();
  if (type != "int16") return fail(wrongField(file, "matrix, dtype", type, "int16"));
  const int orientation = valueOf(root, "orientation").text().as_int(1);
  if (orientation != 1) {
    return fail(wrongField(file, "orientation", std::to_string(orientation), "1 (axial)"));
  }
  const auto shape = numbersOf(valueOf(matrix, "shape"));
  const auto spacing = numbersOf(valueOf(root, "spacing"));
  const bool shapeFits = shape.size() == 3 && std::all_of(shape.begin(), shape.end(), [](double n) {
                           return n >= 1.0 && n <= kMaxSide && n == std::trunc(n);
                         });
  if (!shapeFits || shape[0] * shape[1] * shape[2] > static_cast<double>(kMaxVoxels)) {
    return fail(wrongField(file, "matrix, shape", "another shape", "three counts of voxels"));
  }
  const bool spacingFits =
      spacing.size() == 3 && std::all_of(spacing.begin(), spacing.end(), [](double s) {
        return std::isfinite(s) && s > 0.0 && s < 1000.0;
      });
  if (!spacingFits) return fail(wrongField(file, "spacing", "another spacing", "three lengths"));
  // shape is slices, rows, columns; spacing is columns, rows, slices.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    project.geometry.dims[axis] = static_cast<std::int32_t>(shape[2 - axis]);
    const auto a = static_cast<Eigen::Index>(axis);
    project.geometry.spacing[a] = spacing[axis] * 1e-3;
    project.geometry.X_PV.translation()[a] =
        -0.5 * (project.geometry.dims[axis] - 1) * project.geometry.spacing[a];
  }
  return project;
}

Result<Project> openProject(const fs::path& file) {
  const auto plist = readArchiveMember(file, "main.plist", kMaxPlistBytes);
  if (!plist) return fail(plist.error());
  return parseProject(*plist, file);
}

}  // namespace

bool isInvesaliusProject(const fs::path& file) {
  return isArchive(file) && archiveHolds(file, "main.plist");
}

Result<SeriesInfo> describeInvesalius(const fs::path& file) {
  const auto project = openProject(file);
  if (!project) return fail(project.error());
  SeriesInfo info;
  info.modality = project->modality;
  info.description = "InVesalius project";
  info.files = 1;
  info.importable = true;
  info.geometry = project->geometry;
  return info;
}

Result<ImportedScan> readInvesalius(const fs::path& file) {
  const auto project = openProject(file);
  if (!project) return fail(project.error());
  const GridGeometry& geometry = project->geometry;
  const std::uint64_t expected = geometry.voxelCount() * sizeof(std::int16_t);
  const auto bytes = readArchiveMember(file, project->matrixFile, expected);
  if (!bytes) return fail(bytes.error());
  if (bytes->size() != expected) {
    return fail(inputRefused("The voxels of the InVesalius project are cut short.")
                    .inFile(file.string())
                    .inField(project->matrixFile)
                    .butFound(std::to_string(bytes->size()) + " bytes")
                    .wants(std::to_string(expected) + " bytes")
                    .advise("Copy the project again from where it came."));
  }
  static_assert(std::endian::native == std::endian::little);
  ImportedScan scan;
  scan.volume.geometry = geometry;
  scan.volume.modality = project->modality;
  scan.volume.int16.resize(geometry.voxelCount());
  const auto nx = static_cast<std::size_t>(geometry.dims[0]);
  const auto ny = static_cast<std::size_t>(geometry.dims[1]);
  const std::size_t rows = ny * static_cast<std::size_t>(geometry.dims[2]);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t slice = row / ny;
    const std::size_t flipped = slice * ny + (ny - 1 - row % ny);
    std::memcpy(scan.volume.int16.data() + row * nx,
                bytes->data() + flipped * nx * sizeof(std::int16_t), nx * sizeof(std::int16_t));
  }
  scan.sourceFormat = "InVesalius";
  scan.description = "InVesalius project";
  scan.warnings.emplace_back(
      "The project stores no position in the patient: the volume is centred on the origin.");
  return scan;
}

}  // namespace palpate
