/// Smoothing that keeps thin bone.
///
/// What a ball does not fit into (the label without its opening) is thin, or a bump, or an edge.
/// Edges and bumps are near what the ball fits into; the middle of a sheet or a bar is not. So the
/// thin parts are those voxels that no ball reaches, within twice the ball's radius of one that is
/// farther than that radius from every ball, in pieces six radii long.

#include <algorithm>
#include <cmath>

#include "imaging/components.h"
#include "imaging/segment/blur.h"
#include "imaging/segment/edit.h"

namespace palpate {
namespace {

using plane::kA;
using plane::kB;
using plane::kC;
using plane::kMask;

/// More planes of one byte.
constexpr std::uint8_t kD = 16;

/// Clears plane `of` where its 26-connected parts are shorter than `length_mm` (the diagonal of
/// their box).
void dropShort(MaskBlock& block, std::uint8_t of, double length_mm) {
  const MaskParts parts = findParts(block.voxels, block.dims, {.bits = of});
  std::vector<VoxelBox> boxes(parts.voxels.size());
  const auto ny = static_cast<std::uint32_t>(block.dims[1]);
  for (const MaskRun& run : parts.runs) {
    const auto y = static_cast<std::int32_t>(run.row % ny);
    const auto z = static_cast<std::int32_t>(run.row / ny);
    boxes[run.part] = unite(boxes[run.part], {{run.first, y, z}, {run.last, y, z}});
  }
  for (const MaskRun& run : parts.runs) {
    const auto dims = boxes[run.part].dims();
    const Eigen::Vector3d size =
        Eigen::Vector3d(dims[0], dims[1], dims[2]).cwiseProduct(block.spacing_mm);
    if (size.norm() >= length_mm) continue;
    const std::size_t row =
        static_cast<std::size_t>(run.row) * static_cast<std::size_t>(block.dims[0]);
    for (std::int32_t x = run.first; x <= run.last; ++x) {
      block.voxels[row + static_cast<std::size_t>(x)] &= static_cast<std::uint8_t>(~of);
    }
  }
}

/// Sets kB on what is thin. Uses kA, kC and kD.
Result<void> findThin(MaskBlock& block, double mm, const Share& share) {
  const double radius = std::max(mm, block.spacing_mm.maxCoeff());
  auto done = erode(block, kMask, kA, radius, share.part(0.0, 0.25));
  if (done) done = dilate(block, kA, kC, radius, share.part(0.25, 0.5));  // kC: balls fit
  if (done) done = dilate(block, kC, kA, radius, share.part(0.5, 0.75));  // kA: near a ball
  if (!done) return done;
  for (std::uint8_t& voxel : block.voxels) {
    const bool middle = (voxel & kMask) != 0 && (voxel & kA) == 0;
    voxel = static_cast<std::uint8_t>(middle ? voxel | kD : voxel & ~kD);
  }
  done = dilate(block, kD, kA, 2.0 * radius, share.part(0.75, 1.0));
  if (!done) return done;
  for (std::uint8_t& voxel : block.voxels) {
    const bool thin = (voxel & kMask) != 0 && (voxel & kC) == 0 && (voxel & kA) != 0;
    voxel = static_cast<std::uint8_t>(thin ? voxel | kB : voxel & ~kB);
  }
  dropShort(block, kB, 6.0 * mm);
  return {};
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::Smooth& tool) {
  if (auto fits = within(tool.mm, 0.0, kMostMm, "mm"); !fits) return fits;
  if (tool.mm == 0.0) return {};
  const double margin = blurReach_mm(tool.mm) + edit.geometry().spacing.maxCoeff() * 1e3;
  const VoxelBox box = grownBy(boundsOf(edit.labels, edit.value), margin, edit.geometry());
  MaskBlock block = blockOf(edit.labels, edit.value, box);
  const Share whole = edit.share("Smoothing");
  if (tool.keepThin) {
    if (auto found = findThin(block, tool.mm, whole.part(0.0, 0.7)); !found) return found;
  }
  auto done = blurAndCut(block, kMask, kA, tool.mm, whole.part(tool.keepThin ? 0.7 : 0.0, 1.0));
  if (!done) return done;
  for (std::uint8_t& voxel : block.voxels) {
    const bool in = (voxel & kA) != 0 || (tool.keepThin && (voxel & kB) != 0);
    voxel = in ? kMask : std::uint8_t{0};
  }
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
