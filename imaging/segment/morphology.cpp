#include "imaging/segment/morphology.h"

#include <algorithm>
#include <cmath>

#include "imaging/itk_distance.h"

namespace palpate {
namespace {

/// ITK returns squared distances in single precision.
constexpr double kRounding = 1e-5;

/// Slices [first, end) of plane `from` (or of its complement) as zeros and ones.
std::vector<std::uint8_t> slabOf(const MaskBlock& block, std::uint8_t from, bool complement,
                                 std::int32_t first, std::int32_t end) {
  const std::size_t begin = block.index(0, 0, first);
  std::vector<std::uint8_t> slab(block.sliceVoxels() * static_cast<std::size_t>(end - first));
  for (std::size_t i = 0; i < slab.size(); ++i) {
    slab[i] = ((block.voxels[begin + i] & from) != 0) != complement ? 1 : 0;
  }
  return slab;
}

/// Dilates `from`, or its complement and returns the complement of that.
Result<void> spread(MaskBlock& block, std::uint8_t from, std::uint8_t to, double mm,
                    bool complement, const Share& share) {
  const double limit = mm * mm * (1.0 + kRounding);
  const auto border = static_cast<std::int32_t>(
      std::min<double>(std::ceil(mm / block.spacing_mm.z()), block.dims[2]));
  const std::int32_t nz = block.dims[2];
  const std::int32_t thick = slabSlices(block, border, 2 * sizeof(float) + 2);
  for (std::int32_t first = 0; first < nz; first += thick) {
    if (share.progress.cancelled()) return fail(cancelled());
    share.at(static_cast<double>(first) / nz);
    const std::int32_t end = std::min(nz, first + thick);
    const std::int32_t from0 = std::max(0, first - border), end0 = std::min(nz, end + border);
    const auto slab = slabOf(block, from, complement, from0, end0);
    const bool some = std::find(slab.begin(), slab.end(), std::uint8_t{1}) != slab.end();
    // ITK measures from a set voxel beside one that is not: where all are set it finds none.
    const bool all = std::find(slab.begin(), slab.end(), std::uint8_t{0}) == slab.end();
    const auto distances =
        some && !all ? squaredDistances_mm2(
                           slab, {block.dims[0], block.dims[1], end0 - from0},
                           {block.spacing_mm.x(), block.spacing_mm.y(), block.spacing_mm.z()})
                     : std::vector<float>{};
    const std::size_t skipped = block.sliceVoxels() * static_cast<std::size_t>(first - from0);
    const std::size_t begin = block.index(0, 0, first), stop = block.index(0, 0, end);
    for (std::size_t i = begin; i < stop; ++i) {
      const bool near =
          all || (some && static_cast<double>(distances[i - begin + skipped]) <= limit);
      std::uint8_t& voxel = block.voxels[i];
      voxel = static_cast<std::uint8_t>(near != complement ? voxel | to : voxel & ~to);
    }
  }
  share.at(1.0);
  return {};
}

}  // namespace

std::int32_t slabSlices(const MaskBlock& block, std::int32_t border, std::size_t bytesPerVoxel) {
  const std::size_t fits = block.slabBytes / (bytesPerVoxel * block.sliceVoxels() + 1);
  const auto slices = static_cast<std::int32_t>(std::min<std::size_t>(fits, 1U << 20U));
  return std::max({1, border, slices - 2 * border});
}

Result<void> dilate(MaskBlock& block, std::uint8_t from, std::uint8_t to, double mm,
                    const Share& share) {
  return spread(block, from, to, mm, false, share);
}

Result<void> erode(MaskBlock& block, std::uint8_t from, std::uint8_t to, double mm,
                   const Share& share) {
  return spread(block, from, to, mm, true, share);
}

}  // namespace palpate
