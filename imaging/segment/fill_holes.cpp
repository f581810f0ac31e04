#include <algorithm>

#include "imaging/components.h"
#include "imaging/segment/edit.h"

namespace palpate {

Result<void> carryOut(Edit& edit, const tool::FillHoles& tool) {
  if (auto fits = within(tool.maxMm3, 0.0, 1e12, "max_mm3"); !fits) return fits;
  // One voxel around the label, where the scan has one: what reaches the box's side is outside.
  const VoxelBox box = grownBy(boundsOf(edit.labels, edit.value),
                               edit.geometry().spacing.minCoeff() * 1e3, edit.geometry());
  MaskBlock block = blockOf(edit.labels, edit.value, box);
  const Share share = edit.share("Finding enclosed parts");
  share.at(0.2);
  const MaskParts parts =
      findParts(block.voxels, block.dims,
                {.bits = plane::kMask, .clear = true, .connectivity = Connectivity::Faces});
  if (edit.progress.cancelled()) return fail(cancelled());
  share.at(0.7);
  const auto ny = static_cast<std::uint32_t>(block.dims[1]);
  const auto nz = static_cast<std::uint32_t>(block.dims[2]);
  std::vector<bool> open(parts.voxels.size(), false);
  for (const MaskRun& run : parts.runs) {
    const std::uint32_t y = run.row % ny, z = run.row / ny;
    const bool side = run.first == 0 || run.last == block.dims[0] - 1 || y == 0 || y == ny - 1 ||
                      z == 0 || z == nz - 1;
    if (side) open[run.part] = true;
  }
  const double mm3 = block.spacing_mm.prod();
  std::vector<bool> holes(open.size());
  for (std::size_t part = 0; part < holes.size(); ++part) {
    const bool tooLarge = tool.maxMm3 > 0.0 && static_cast<double>(parts.voxels[part]) * mm3 >
                                                   tool.maxMm3 * (1.0 + 1e-9);
    holes[part] = !open[part] && !tooLarge;
  }
  fillParts(parts, holes, plane::kMask, block.dims[0], block.voxels);
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
