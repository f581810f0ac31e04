#include <algorithm>
#include <cmath>
#include <limits>

#include "imaging/components.h"
#include "imaging/segment/edit.h"

namespace palpate {
namespace {

/// Where the region can be: the scan, or what is within reach of a seed.
VoxelBox reachOf(const GridGeometry& geometry,
                 const std::vector<std::array<std::int32_t, 3>>& seeds, double reach_mm) {
  if (reach_mm == 0.0) return wholeBox(geometry);
  VoxelBox box;
  for (const auto& seed : seeds) box = unite(box, {seed, seed});
  return grownBy(box, reach_mm, geometry);
}

/// Sets kA where a voxel is in range, and within reach of a seed.
void markCandidates(const Edit& edit, const tool::GrowRegion& tool, MaskBlock& block) {
  const VoxelBox& box = block.box;
  const double reach2 = tool.reach_mm * tool.reach_mm * (1.0 + 1e-9);
  std::vector<Eigen::Vector3d> seeds_V_mm;
  const Eigen::Isometry3d X_VP = edit.geometry().X_PV.inverse();
  for (const Eigen::Vector3d& seed : tool.seeds_mm)
    seeds_V_mm.push_back(X_VP * (seed * 1e-3) * 1e3);
  const auto reached = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    return tool.reach_mm == 0.0 ||
           std::any_of(seeds_V_mm.begin(), seeds_V_mm.end(), [&](const Eigen::Vector3d& seed) {
             const Eigen::Vector3d centre = edit.geometry().centre_V(x, y, z) * 1e3;
             return (centre - seed).squaredNorm() <= reach2;
           });
  };
  forEachRow(edit.geometry(), box,
             [&](std::size_t first, std::int32_t count, std::int32_t y, std::int32_t z) {
               const std::size_t to = block.index(0, y - box.low[1], z - box.low[2]);
               for (std::int32_t x = 0; x < count; ++x) {
                 const double value = edit.volume.value(first + static_cast<std::size_t>(x));
                 if (value >= tool.range.low && value <= tool.range.high &&
                     reached(box.low[0] + x, y, z)) {
                   block.voxels[to + static_cast<std::size_t>(x)] |= plane::kA;
                 }
               }
             });
}

Error noSeedInRange(const Edit& edit, const std::array<std::int32_t, 3>& seed) {
  const double value = edit.volume.value(edit.geometry().index(seed[0], seed[1], seed[2]));
  return inputRefused("No seed lies in the range.")
      .inField("seeds")
      .butFound("the value " + std::to_string(static_cast<long>(std::lround(value))) +
                " at the first seed")
      .wants("a seed whose value is in the range")
      .advise("Click on the tissue itself, or widen the range.");
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::GrowRegion& tool) {
  if (auto fits = checkRange(tool.range); !fits) return fits;
  if (auto fits = within(tool.reach_mm, 0.0, 1e4, "reach_mm"); !fits) return fits;
  if (tool.seeds_mm.empty()) {
    return fail(usageError("There is no seed to grow from.")
                    .inField("seeds")
                    .advise("Click on the tissue to grow."));
  }
  std::vector<std::array<std::int32_t, 3>> seeds;
  for (std::size_t i = 0; i < tool.seeds_mm.size(); ++i) {
    const auto voxel = voxelOf(edit, tool.seeds_mm[i], "seeds[" + std::to_string(i) + "]");
    if (!voxel) return fail(voxel.error());
    seeds.push_back(*voxel);
  }
  MaskBlock block =
      blockOf(edit.labels, edit.value, reachOf(edit.geometry(), seeds, tool.reach_mm));
  const Share share = edit.share("Growing from the seeds");
  share.at(0.1);
  markCandidates(edit, tool, block);
  if (edit.progress.cancelled()) return fail(cancelled());
  share.at(0.4);
  const MaskParts parts = findParts(block.voxels, block.dims, {.bits = plane::kA});
  if (edit.progress.cancelled()) return fail(cancelled());
  share.at(0.8);
  std::vector<bool> chosen(parts.voxels.size(), false);
  bool any = false;
  for (const auto& seed : seeds) {
    const auto part = partOf(parts, block, seed);
    if (part) chosen[*part] = any = true;
  }
  if (!any) return fail(noSeedInRange(edit, seeds.front()));
  fillParts(parts, chosen, plane::kMask, block.dims[0], block.voxels);
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
