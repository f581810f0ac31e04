#include "imaging/segment/mask_block.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// First and last voxel of the value in a row; {nx, -1} without one.
std::array<std::int32_t, 2> extentOfRow(const std::uint8_t* row, std::int32_t nx,
                                        std::uint8_t value) {
  const auto* end = row + nx;
  const auto* first = std::find(row, end, value);
  if (first == end) return {nx, -1};
  const auto* last = end - 1;
  while (*last != value) --last;
  return {static_cast<std::int32_t>(first - row), static_cast<std::int32_t>(last - row)};
}

}  // namespace

VoxelBox wholeBox(const GridGeometry& g) {
  return {{0, 0, 0}, {g.dims[0] - 1, g.dims[1] - 1, g.dims[2] - 1}};
}

VoxelBox boundsOf(const LabelGrid& labels, std::uint8_t value) {
  const auto& dims = labels.geometry.dims;
  VoxelBox box{dims, {-1, -1, -1}};
  for (std::int32_t z = 0; z < dims[2]; ++z) {
    for (std::int32_t y = 0; y < dims[1]; ++y) {
      const auto [first, last] =
          extentOfRow(labels.labels.data() + labels.geometry.index(0, y, z), dims[0], value);
      if (last < 0) continue;
      box = unite(box, {{first, y, z}, {last, y, z}});
    }
  }
  return box;
}

VoxelBox unite(const VoxelBox& a, const VoxelBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  VoxelBox box;
  for (std::size_t d = 0; d < 3; ++d) {
    box.low[d] = std::min(a.low[d], b.low[d]);
    box.high[d] = std::max(a.high[d], b.high[d]);
  }
  return box;
}

VoxelBox grownBy(const VoxelBox& box, double mm, const GridGeometry& geometry) {
  if (box.empty()) return box;
  VoxelBox grown = box;
  const Eigen::Vector3d spacing = spacing_mm(geometry);
  for (std::size_t d = 0; d < 3; ++d) {
    const double voxels = std::ceil(mm / spacing[static_cast<Eigen::Index>(d)]);
    const auto by = static_cast<std::int32_t>(std::min<double>(voxels, geometry.dims[d]));
    grown.low[d] = std::max(0, box.low[d] - by);
    grown.high[d] = std::min(geometry.dims[d] - 1, box.high[d] + by);
  }
  return grown;
}

void forEachRow(
    const GridGeometry& geometry, const VoxelBox& box,
    const std::function<void(std::size_t, std::int32_t, std::int32_t, std::int32_t)>& row) {
  if (box.empty()) return;
  const std::int32_t count = box.high[0] - box.low[0] + 1;
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(box.low[2], box.high[2] + 1),
                    [&](const tbb::blocked_range<std::int32_t>& slices) {
                      for (std::int32_t z = slices.begin(); z < slices.end(); ++z) {
                        for (std::int32_t y = box.low[1]; y <= box.high[1]; ++y) {
                          row(geometry.index(box.low[0], y, z), count, y, z);
                        }
                      }
                    });
}

MaskBlock blockOf(const LabelGrid& labels, std::uint8_t value, const VoxelBox& box) {
  MaskBlock block;
  block.box = box;
  block.dims = box.dims();
  block.spacing_mm = spacing_mm(labels.geometry);
  block.voxels.resize(block.sliceVoxels() * static_cast<std::size_t>(block.dims[2]));
  forEachRow(labels.geometry, box,
             [&](std::size_t first, std::int32_t count, std::int32_t y, std::int32_t z) {
               const std::uint8_t* from = labels.labels.data() + first;
               std::uint8_t* to =
                   block.voxels.data() + block.index(0, y - box.low[1], z - box.low[2]);
               std::transform(from, from + count, to, [value](std::uint8_t label) {
                 return label == value ? plane::kMask : std::uint8_t{0};
               });
             });
  return block;
}

void copyPlane(MaskBlock& block, std::uint8_t from, std::uint8_t to, bool complement) {
  for (std::uint8_t& voxel : block.voxels) {
    const bool set = ((voxel & from) != 0) != complement;
    voxel = static_cast<std::uint8_t>(set ? voxel | to : voxel & ~to);
  }
}

bool anySet(const MaskBlock& block, std::uint8_t bits) {
  return std::any_of(block.voxels.begin(), block.voxels.end(),
                     [bits](std::uint8_t voxel) { return (voxel & bits) != 0; });
}

}  // namespace palpate
