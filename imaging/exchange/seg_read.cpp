#include "imaging/exchange/seg_read.h"

#include <algorithm>
#include <vector>

#include "core/base/counted.h"
#include "imaging/exchange/grid_fit.h"
#include "imaging/exchange/seg_file.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

/// Paints one frame; notes the voxels that another segment had.
void paint(const SegFile& seg, std::size_t frame, const GridFit& fit, std::uint8_t value,
           LabelGrid& grid, std::vector<bool>& shared) {
  std::size_t pixel = 0;
  for (std::uint32_t row = 0; row < seg.rows; ++row) {
    for (std::uint32_t column = 0; column < seg.columns; ++column, ++pixel) {
      if (!seg.isSet(frame, pixel)) continue;
      const std::size_t at =
          fit.index(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row), 0);
      std::uint8_t& label = grid.labels[at];
      if (label != 0 && label != value) {
        if (shared.empty()) shared.resize(grid.labels.size());
        shared[at] = true;
      }
      label = value;
    }
  }
}

/// All places first, so that a file that does not fit costs no memory.
Result<std::vector<GridFit>> fitFrames(const SegFile& seg, const GridGeometry& geometry,
                                       const fs::path& file) {
  std::vector<GridFit> fits;
  fits.reserve(seg.frames.size());
  for (std::size_t f = 0; f < seg.frames.size(); ++f) {
    const std::string field =
        "ImagePositionPatient, ImageOrientationPatient, PixelSpacing of frame ";
    auto fit = fitToGrid(seg.frames[f].place, geometry, file, field + std::to_string(f + 1));
    if (!fit) return fail(fit.error());
    fits.push_back(*fit);
  }
  return fits;
}

void addWarnings(const SegFile& seg, const std::vector<bool>& shared, bool cut,
                 std::vector<std::string>& warnings) {
  if (seg.fractional) {
    warnings.emplace_back(
        "The segmentation is fractional: voxels of one half and more are taken, the others not.");
  }
  const auto count = std::count(shared.begin(), shared.end(), true);
  if (count > 0) {
    warnings.push_back("Segments overlap in " +
                       counted(static_cast<std::size_t>(count), "voxel", "voxels") +
                       "; the later segment has them.");
  }
  if (cut) warnings.emplace_back("A label's name is longer than 256 bytes and was cut.");
}

}  // namespace

Result<FoundLabels> readDicomSeg(const fs::path& file, const GridGeometry& geometry,
                                 const Progress& progress) {
  auto seg = readSegFile(file);
  if (!seg) return fail(seg.error());
  const auto fits = fitFrames(*seg, geometry, file);
  if (!fits) return fail(fits.error());
  FoundLabels found;
  found.grid.geometry = geometry;
  found.grid.labels.assign(geometry.voxelCount(), 0);
  std::vector<std::vector<std::size_t>> framesOf(seg->segments.size());
  for (std::size_t f = 0; f < seg->frames.size(); ++f)
    framesOf[seg->frames[f].segment].push_back(f);
  std::vector<bool> shared;
  bool cut = false;
  for (std::size_t s = 0; s < seg->segments.size(); ++s) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(s) / static_cast<double>(seg->segments.size()), "Placing frames");
    const auto value = static_cast<std::uint8_t>(s + 1);
    for (const std::size_t f : framesOf[s]) {
      paint(*seg, f, (*fits)[f], value, found.grid, shared);
    }
    found.labels.push_back(
        {labelName(seg->segments[s].label, value, cut), value, seg->segments[s].colour});
  }
  addWarnings(*seg, shared, cut, found.warnings);
  settleLabels(found);
  return found;
}

}  // namespace palpate
