#include "imaging/segment/surface_distances.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
/// Slices from a voxel to the nearest set one of its column; this where the column has none.
constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();
/// Voxels whose gaps are held at a time: 32 MiB, and work for several threads between two reports.
constexpr std::size_t kBatchVoxels = std::size_t{8} << 20U;

/// The lower envelope of parabolas that stand on a line of samples, and its values.
class Envelope {
 public:
  /// @param longest  the most samples of a line.
  explicit Envelope(std::size_t longest) : apex_(longest), height_(longest), from_(longest + 1) {}

  /// value[i] becomes min over j of value[j] + (spacing (i - j))²; `stride` between samples.
  void pass(double* value, std::size_t count, std::size_t stride, double spacing) {
    std::size_t parabolas = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double height = value[i * stride];
      if (height == kNowhere) continue;
      const double x = spacing * static_cast<double>(i);
      double start = -kNowhere;
      for (; parabolas > 0; --parabolas) {
        const std::size_t top = parabolas - 1;
        const double apex = apex_[top];
        // Where the new parabola gets below the one before.
        start = ((height + x * x) - (height_[top] + apex * apex)) / (2.0 * (x - apex));
        if (start > from_[top]) break;
        start = -kNowhere;
      }
      apex_[parabolas] = x;
      height_[parabolas] = height;
      from_[parabolas++] = start;
    }
    if (parabolas == 0) return;
    from_[parabolas] = kNowhere;
    std::size_t at = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = spacing * static_cast<double>(i);
      while (from_[at + 1] < x) ++at;
      const double along = x - apex_[at];
      value[i * stride] = height_[at] + along * along;
    }
  }

 private:
  std::vector<double> apex_, height_, from_;
};

/// For each voxel of some slices, how many slices away the nearest set voxel of its column is.
class ColumnGaps {
 public:
  ColumnGaps(const MaskBlock& block, std::uint8_t bit)
      : block_(block),
        bit_(bit),
        nx_(static_cast<std::size_t>(block.dims[0])),
        plane_(block.sliceVoxels()),
        below_(plane_, kNone),
        ahead_(plane_, -1) {}

  /// Of the slices [first, end), which follow those of the call before.
  void fill(std::int32_t first, std::int32_t end, std::vector<std::int32_t>& gaps) {
    gaps.resize(static_cast<std::size_t>(end - first) * plane_);
    tbb::parallel_for(std::int32_t{0}, block_.dims[1], [&](std::int32_t y) {
      const std::size_t row = static_cast<std::size_t>(y) * nx_;
      fillUpwards(row, first, end, gaps.data() + row);
      fillDownwards(row, first, end, gaps.data() + row);
    });
  }

 private:
  [[nodiscard]] const std::uint8_t* rowAt(std::size_t row, std::int32_t z) const {
    return block_.voxels.data() + static_cast<std::size_t>(z) * plane_ + row;
  }

  void fillUpwards(std::size_t row, std::int32_t first, std::int32_t end, std::int32_t* gap) {
    for (std::int32_t z = first; z < end; ++z, gap += plane_) {
      const std::uint8_t* bits = rowAt(row, z);
      for (std::size_t x = 0; x < nx_; ++x) {
        std::int32_t& below = below_[row + x];
        if ((bits[x] & bit_) != 0) below = z;
        gap[x] = below == kNone ? kNone : z - below;
      }
    }
  }

  void fillDownwards(std::size_t row, std::int32_t first, std::int32_t end, std::int32_t* gap) {
    std::vector<std::int32_t> above(nx_);
    for (std::size_t x = 0; x < nx_; ++x) above[x] = nextAhead(row, x, end - 1);
    gap += static_cast<std::size_t>(end - first) * plane_;
    for (std::int32_t z = end - 1; z >= first; --z) {
      gap -= plane_;
      const std::uint8_t* bits = rowAt(row, z);
      for (std::size_t x = 0; x < nx_; ++x) {
        if ((bits[x] & bit_) != 0) above[x] = z;
        if (above[x] != kNone) gap[x] = std::min(gap[x], above[x] - z);
      }
    }
  }

  /// The first set slice from z up. Kept, so that all calls look through a column once.
  std::int32_t nextAhead(std::size_t row, std::size_t x, std::int32_t z) {
    std::int32_t& ahead = ahead_[row + x];
    if (ahead < z) {
      ahead = z;
      while (ahead < block_.dims[2] && (rowAt(row, ahead)[x] & bit_) == 0) ++ahead;
      if (ahead == block_.dims[2]) ahead = kNone;
    }
    return ahead;
  }

  const MaskBlock& block_;
  std::uint8_t bit_;
  std::size_t nx_, plane_;
  std::vector<std::int32_t> below_, ahead_;  ///< Last set slice so far; first set one further on.
};

/// One slice's distances from its gaps. One a worker.
class SliceDistances {
 public:
  explicit SliceDistances(const MaskBlock& block)
      : block_(block),
        nx_(static_cast<std::size_t>(block.dims[0])),
        ny_(static_cast<std::size_t>(block.dims[1])),
        envelope_(std::max(nx_, ny_)),
        squares_(ny_ * stride()),
        wanted_(nx_) {}

  /// Empty where the slice has no voxel with the bit.
  std::vector<float> operator()(const std::uint8_t* bits, std::uint8_t from,
                                const std::int32_t* gaps) {
    std::fill(wanted_.begin(), wanted_.end(), std::uint8_t{0});
    std::size_t count = 0;
    for (std::size_t i = 0; i < nx_ * ny_; ++i) {
      if ((bits[i] & from) == 0) continue;
      wanted_[i % nx_] = 1;
      ++count;
    }
    std::vector<float> distances;
    if (count == 0) return distances;
    distances.reserve(count);
    for (std::size_t y = 0; y < ny_; ++y) {
      double* row = squares_.data() + y * stride();
      for (std::size_t x = 0; x < nx_; ++x) row[x] = squareOf(gaps[y * nx_ + x]);
      envelope_.pass(row, nx_, 1, block_.spacing_mm.x());
    }
    for (std::size_t x = 0; x < nx_; ++x) {
      if (wanted_[x] != 0) {
        envelope_.pass(squares_.data() + x, ny_, stride(), block_.spacing_mm.y());
      }
    }
    for (std::size_t y = 0; y < ny_; ++y) {
      for (std::size_t x = 0; x < nx_; ++x) {
        if ((bits[y * nx_ + x] & from) == 0) continue;
        distances.push_back(static_cast<float>(std::sqrt(squares_[y * stride() + x])));
      }
    }
    return distances;
  }

 private:
  /// Odd in cache lines, or the samples of a column of 512 would all want one place of the cache.
  [[nodiscard]] std::size_t stride() const { return (nx_ / 16 * 2 + 3) * 8; }
  [[nodiscard]] double squareOf(std::int32_t gap) const {
    const double along = block_.spacing_mm.z() * static_cast<double>(gap);
    return gap == kNone ? kNowhere : along * along;
  }

  const MaskBlock& block_;
  std::size_t nx_, ny_;
  Envelope envelope_;
  std::vector<double> squares_;
  std::vector<std::uint8_t> wanted_;  ///< Columns that hold a voxel to answer for.
};

}  // namespace

Result<std::vector<float>> nearestDistances_mm(const MaskBlock& block, std::uint8_t from,
                                               std::uint8_t to, const Share& share) {
  assert(std::any_of(block.voxels.begin(), block.voxels.end(),
                     [to](auto b) { return (b & to) != 0; }));
  const std::size_t plane = block.sliceVoxels();
  const auto slices = static_cast<std::int32_t>(
      std::clamp<std::size_t>(kBatchVoxels / plane, 1, static_cast<std::size_t>(block.dims[2])));
  ColumnGaps columns(block, to);
  tbb::enumerable_thread_specific<SliceDistances> workers(
      [&block] { return SliceDistances(block); });
  std::vector<std::int32_t> gaps;
  std::vector<std::vector<float>> found(static_cast<std::size_t>(slices));
  std::vector<float> distances;
  for (std::int32_t first = 0; first < block.dims[2]; first += slices) {
    if (share.progress.cancelled()) return fail(cancelled());
    const std::int32_t end = std::min(first + slices, block.dims[2]);
    columns.fill(first, end, gaps);
    tbb::parallel_for(first, end, [&](std::int32_t z) {
      const auto at = static_cast<std::size_t>(z - first);
      found[at] = workers.local()(block.voxels.data() + static_cast<std::size_t>(z) * plane, from,
                                  gaps.data() + at * plane);
    });
    for (std::size_t s = 0; s < static_cast<std::size_t>(end - first); ++s) {
      distances.insert(distances.end(), found[s].begin(), found[s].end());
    }
    share.at(static_cast<double>(end) / block.dims[2]);
  }
  return distances;
}

}  // namespace palpate
