#include "core/voxels/surface_descriptor.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace palpate {
namespace {

// Calls f(index of neighbour) for the face neighbours in the grid, f(none) for those outside.
template <class F>
void forEachFace(const GridGeometry& g, std::int32_t i, std::int32_t j, std::int32_t k, F&& f) {
  constexpr std::int32_t kStep[6][3] = {{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                        {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
  for (const auto& d : kStep) {
    const bool inside = g.contains(i + d[0], j + d[1], k + d[2]);
    f(inside, inside ? g.index(i + d[0], j + d[1], k + d[2]) : 0);
  }
}

template <class F>
void forEachVoxel(const GridGeometry& g, F&& f) {
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, g.dims[2]), [&](const auto& range) {
    for (std::int32_t k = range.begin(); k != range.end(); ++k) {
      for (std::int32_t j = 0; j < g.dims[1]; ++j) {
        for (std::int32_t i = 0; i < g.dims[0]; ++i) f(i, j, k, g.index(i, j, k));
      }
    }
  });
}

}  // namespace

std::vector<SurfaceDescriptor> classifySurface(const GridGeometry& geometry,
                                               std::span<const std::uint8_t> solid) {
  std::vector<SurfaceDescriptor> kind(geometry.voxelCount(), SurfaceDescriptor::Empty);
  forEachVoxel(geometry, [&](auto i, auto j, auto k, std::size_t at) {
    if (solid[at] == 0) return;
    bool open = false;
    forEachFace(geometry, i, j, k,
                [&](bool inside, std::size_t next) { open = open || !inside || solid[next] == 0; });
    kind[at] = open ? SurfaceDescriptor::Surface : SurfaceDescriptor::Full;
  });
  // A full neighbour of an empty voxel is a surface voxel: no need to read `kind`, which other
  // threads are writing.
  forEachVoxel(geometry, [&](auto i, auto j, auto k, std::size_t at) {
    if (solid[at] != 0) return;
    bool near = false;
    forEachFace(geometry, i, j, k, [&](bool inside, std::size_t next) {
      near = near || (inside && solid[next] != 0);
    });
    if (near) kind[at] = SurfaceDescriptor::Proximity;
  });
  return kind;
}

std::vector<std::array<std::int32_t, 3>> surfaceVoxels(const GridGeometry& geometry,
                                                       std::span<const std::uint8_t> solid) {
  const auto kind = classifySurface(geometry, solid);
  std::vector<std::array<std::int32_t, 3>> voxels;
  std::size_t at = 0;
  for (std::int32_t k = 0; k < geometry.dims[2]; ++k) {
    for (std::int32_t j = 0; j < geometry.dims[1]; ++j) {
      for (std::int32_t i = 0; i < geometry.dims[0]; ++i, ++at) {
        if (kind[at] == SurfaceDescriptor::Surface) voxels.push_back({i, j, k});
      }
    }
  }
  return voxels;
}

}  // namespace palpate
