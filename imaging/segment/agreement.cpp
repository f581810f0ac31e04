#include "imaging/segment/agreement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "imaging/segment/mask_block.h"
#include "imaging/segment/surface_distances.h"

namespace palpate {
namespace {

std::string countsText(const GridGeometry& geometry) {
  return std::to_string(geometry.dims[0]) + " x " + std::to_string(geometry.dims[1]) + " x " +
         std::to_string(geometry.dims[2]) + " voxels";
}

Result<void> refuseOtherGrid(const GridGeometry& a, const GridGeometry& b) {
  if (a.sameAs(b)) return {};
  std::string found = countsText(b);
  if (a.dims == b.dims) {
    found += ", corners up to " + std::to_string(a.cornerDistance(b) * 1e3) + " mm away";
  }
  return fail(inputRefused("The two masks do not lie on the same grid.")
                  .inField("geometry")
                  .butFound(found)
                  .wants(countsText(a) + " at the same place")
                  .advise("Resample one onto the other's grid in the program that made it."));
}

bool holds(const MaskOfLabels& mask, std::size_t voxel) {
  const std::uint8_t label = mask.grid.labels[voxel];
  return mask.value ? label == *mask.value : label != 0;
}

/// Counts, and where the voxels are, slice by slice.
struct Tally {
  std::size_t a = 0, b = 0, common = 0;
  VoxelBox box;

  void add(const Tally& other) {
    a += other.a;
    b += other.b;
    common += other.common;
    box = unite(box, other.box);
  }
};

Tally tallySlice(const MaskOfLabels& a, const MaskOfLabels& b, std::int32_t z) {
  Tally tally;
  const auto& dims = a.grid.geometry.dims;
  for (std::int32_t y = 0; y < dims[1]; ++y) {
    const std::size_t row = a.grid.geometry.index(0, y, z);
    std::int32_t first = dims[0];
    std::int32_t last = -1;
    for (std::int32_t x = 0; x < dims[0]; ++x) {
      const std::size_t voxel = row + static_cast<std::size_t>(x);
      const bool inA = holds(a, voxel);
      const bool inB = holds(b, voxel);
      if (!inA && !inB) continue;
      tally.a += inA ? 1 : 0;
      tally.b += inB ? 1 : 0;
      tally.common += inA && inB ? 1 : 0;
      first = std::min(first, x);
      last = x;
    }
    if (last >= 0) tally.box = unite(tally.box, {{first, y, z}, {last, y, z}});
  }
  return tally;
}

Tally tallyOf(const MaskOfLabels& a, const MaskOfLabels& b) {
  const std::int32_t slices = a.grid.geometry.dims[2];
  std::vector<Tally> each(static_cast<std::size_t>(slices));
  tbb::parallel_for(std::int32_t{0}, slices, [&](std::int32_t z) {
    each[static_cast<std::size_t>(z)] = tallySlice(a, b, z);
  });
  Tally tally;
  for (const Tally& slice : each) tally.add(slice);
  return tally;
}

/// The voxel is of the mask and one of its six neighbours is not, or lies beyond the scan.
bool isSurface(const MaskOfLabels& mask, const std::array<std::int32_t, 3>& at, std::size_t voxel) {
  if (!holds(mask, voxel)) return false;
  const auto& dims = mask.grid.geometry.dims;
  std::size_t stride = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    if (at[d] == 0 || at[d] + 1 == dims[d]) return true;
    if (!holds(mask, voxel - stride) || !holds(mask, voxel + stride)) return true;
    stride *= static_cast<std::size_t>(dims[d]);
  }
  return false;
}

/// The surfaces of both masks within the box, as the planes kA and kB.
MaskBlock surfacesOf(const MaskOfLabels& a, const MaskOfLabels& b, const VoxelBox& box) {
  const GridGeometry& geometry = a.grid.geometry;
  MaskBlock surfaces;
  surfaces.box = box;
  surfaces.dims = box.dims();
  surfaces.spacing_mm = spacing_mm(geometry);
  surfaces.voxels.resize(surfaces.sliceVoxels() * static_cast<std::size_t>(surfaces.dims[2]));
  tbb::parallel_for(std::int32_t{0}, surfaces.dims[2], [&](std::int32_t slice) {
    std::uint8_t* bits = surfaces.voxels.data() + surfaces.index(0, 0, slice);
    const std::int32_t z = box.low[2] + slice;
    for (std::int32_t y = box.low[1]; y <= box.high[1]; ++y) {
      for (std::int32_t x = box.low[0]; x <= box.high[0]; ++x, ++bits) {
        const std::size_t voxel = geometry.index(x, y, z);
        const int ofA = isSurface(a, {x, y, z}, voxel) ? plane::kA : 0;
        const int ofB = isSurface(b, {x, y, z}, voxel) ? plane::kB : 0;
        *bits = static_cast<std::uint8_t>(ofA | ofB);
      }
    }
  });
  return surfaces;
}

/// Between the two nearest of the sorted values, as numpy.percentile does. Reorders `values`.
double percentile(std::vector<float>& values, double share) {
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::ptrdiff_t>(place);
  const auto low = values.begin() + below;
  std::nth_element(values.begin(), low, values.end());
  const auto above = std::min_element(low + 1, values.end());
  if (above == values.end()) return static_cast<double>(*low);
  const double rest = place - static_cast<double>(below);
  return (1.0 - rest) * static_cast<double>(*low) + rest * static_cast<double>(*above);
}

/// Reorders `distances`, which are not none.
DistanceSummary summarise(std::vector<float>& distances) {
  DistanceSummary summary;
  double sum = 0.0;
  for (const float distance : distances) {
    sum += static_cast<double>(distance);
    summary.worst = std::max(summary.worst, static_cast<double>(distance));
  }
  summary.mean = sum / static_cast<double>(distances.size());
  summary.median = percentile(distances, 0.5);
  summary.p95 = percentile(distances, 0.95);
  return summary;
}

Result<SurfaceAgreement> compareSurfaces(const MaskBlock& surfaces, const Share& share) {
  auto there = nearestDistances_mm(surfaces, plane::kA, plane::kB, share.part(0.0, 0.5));
  if (!there) return fail(there.error());
  auto back = nearestDistances_mm(surfaces, plane::kB, plane::kA, share.part(0.5, 1.0));
  if (!back) return fail(back.error());
  SurfaceAgreement surface;
  surface.voxels = {there->size(), back->size()};
  surface.aToB = summarise(*there);
  surface.bToA = summarise(*back);
  there->insert(there->end(), back->begin(), back->end());
  surface.symmetric = summarise(*there);
  surface.symmetric.p95 = std::max(surface.aToB.p95, surface.bToA.p95);
  return surface;
}

}  // namespace

Result<Agreement> compareMasks(const MaskOfLabels& a, const MaskOfLabels& b,
                               const Progress& progress) {
  const GridGeometry& geometry = a.grid.geometry;
  if (auto same = refuseOtherGrid(geometry, b.grid.geometry); !same) return fail(same.error());
  progress(0.0, "Counting voxels");
  const Tally tally = tallyOf(a, b);
  if (tally.a + tally.b == 0) {
    return fail(inputRefused("Both masks are empty, so there is nothing to compare.")
                    .inField("voxels")
                    .butFound("no voxel in either")
                    .wants("a voxel in one of them")
                    .advise("Choose labels that hold something."));
  }
  Agreement agreement;
  agreement.voxels = {tally.a, tally.b};
  agreement.common = tally.common;
  const double voxel_mm3 = geometry.spacing.prod() * 1e9;
  const auto inA = static_cast<double>(tally.a);
  const auto inB = static_cast<double>(tally.b);
  const auto common = static_cast<double>(tally.common);
  agreement.mm3 = {inA * voxel_mm3, inB * voxel_mm3};
  agreement.dice = 2.0 * common / (inA + inB);
  agreement.jaccard = common / (inA + inB - common);
  if (tally.a == 0 || tally.b == 0) return agreement;
  progress(0.1, "Finding the surfaces");
  if (progress.cancelled()) return fail(cancelled());
  auto surface =
      compareSurfaces(surfacesOf(a, b, tally.box), {progress, 0.2, 1.0, "Measuring distances"});
  if (!surface) return fail(surface.error());
  agreement.surface = *surface;
  return agreement;
}

}  // namespace palpate
