#include "core/voxels/sealed_cavities.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/disjoint_sets.h"
#include "core/voxels/banded_distance.h"
#include "core/voxels/depth_palette.h"

namespace palpate {
namespace {

constexpr std::uint32_t kOutside = 0;  // the set of what is connected with outside the grid
constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// A run of free voxels in one row; its set is its number, from 1.
struct FreeRun {
  std::int32_t first = 0, last = 0;
};

/// The free runs of a grid, row after row, and which are connected.
class FreeSpace {
 public:
  FreeSpace(const LabelGrid& grid, const SolidLabels& solid)
      : grid_(grid), solid_(solid), dims_(grid.geometry.dims) {
    sets_.add();  // kOutside
    rowStart_.reserve(static_cast<std::size_t>(dims_[1]) * static_cast<std::size_t>(dims_[2]) + 1);
    for (std::int32_t k = 0; k < dims_[2]; ++k) {
      for (std::int32_t j = 0; j < dims_[1]; ++j) addRow(j, k);
    }
    rowStart_.push_back(runs_.size());
  }

  [[nodiscard]] SealedCavities cavities() {
    SealedCavities found;
    std::vector<std::uint32_t> number(runs_.size() + 1, kNone);
    std::size_t row = 0;
    for (std::int32_t k = 0; k < dims_[2]; ++k) {
      for (std::int32_t j = 0; j < dims_[1]; ++j, ++row) {
        for (std::size_t r = rowStart_[row]; r < rowStart_[row + 1]; ++r) {
          const std::uint32_t name = sets_.root(static_cast<std::uint32_t>(r + 1));
          if (name == kOutside) continue;
          if (number[name] == kNone) {
            number[name] = static_cast<std::uint32_t>(found.cavity.size());
            SealedCavity cavity;
            cavity.box = {{runs_[r].first, j, k}, {runs_[r].first, j, k}};
            cavity.wall = grid_.at(runs_[r].first - 1, j, k);
            found.cavity.push_back(cavity);
          }
          take(runs_[r], j, k, number[name], found);
        }
      }
    }
    return found;
  }

 private:
  void addRow(std::int32_t j, std::int32_t k) {
    rowStart_.push_back(runs_.size());
    const std::uint8_t* row = grid_.labels.data() + grid_.geometry.index(0, j, k);
    const bool border = j == 0 || k == 0 || j + 1 == dims_[1] || k + 1 == dims_[2];
    for (std::int32_t i = 0; i < dims_[0]; ++i) {
      if (solid_[row[i]]) continue;
      FreeRun run{i, i};
      while (run.last + 1 < dims_[0] && !solid_[row[run.last + 1]]) ++run.last;
      i = run.last;
      runs_.push_back(run);
      const std::uint32_t set = sets_.add();
      if (border || run.first == 0 || run.last + 1 == dims_[0]) sets_.join(set, kOutside);
    }
    // The four rows before this one that share faces, edges or corners with it.
    for (const auto& step : {std::array{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) {
      const std::int32_t y = j + step[0], z = k + step[1];
      if (y < 0 || z < 0 || y >= dims_[1]) continue;
      joinRows(static_cast<std::size_t>(z) * static_cast<std::size_t>(dims_[1]) +
               static_cast<std::size_t>(y));
    }
  }

  /// The last row with an earlier one.
  void joinRows(std::size_t other) {
    std::size_t a = rowStart_[other];
    std::size_t b = rowStart_.back();
    while (a < rowStart_[other + 1] && b < runs_.size()) {
      // Corners count: runs that end and begin one apart touch.
      if (runs_[a].first <= runs_[b].last + 1 && runs_[b].first <= runs_[a].last + 1) {
        sets_.join(static_cast<std::uint32_t>(a + 1), static_cast<std::uint32_t>(b + 1));
      }
      runs_[a].last < runs_[b].last ? ++a : ++b;
    }
  }

  void take(const FreeRun& run, std::int32_t j, std::int32_t k, std::uint32_t number,
            SealedCavities& found) const {
    SealedCavity& cavity = found.cavity[number];
    cavity.box.include({run.first, j, k});
    cavity.box.include({run.last, j, k});
    const auto count = static_cast<std::uint32_t>(run.last + 1 - run.first);
    cavity.voxels += count;
    found.runs.push_back({grid_.geometry.index(run.first, j, k), count, number});
  }

  const LabelGrid& grid_;
  const SolidLabels& solid_;
  const Extent3 dims_;
  std::vector<FreeRun> runs_;
  std::vector<std::size_t> rowStart_;
  DisjointSets sets_;
};

// Slices worked on at a time: each slab of distances costs what its reach does besides.
constexpr std::int32_t kSlab = 32;

/// Looks for voxels that contacts from outside read and that would change.
class FillCheck {
 public:
  FillCheck(const LabelGrid& grid, const SolidLabels& solid, const SealedCavities& cavities,
            const std::vector<bool>& wanted, LeafModel leaf)
      : dims_(grid.geometry.dims),
        cavities_(cavities),
        wanted_(wanted),
        palette_(grid.geometry.spacing),
        solid_(bitsOf(grid, solid)),
        filled_(solid_),
        kept_(cavities.cavity.size()) {
    for (const CavityRun& run : cavities.runs) {
      if (!wanted[run.cavity]) continue;
      const auto at = voxelOf(run.first);
      for (std::uint32_t i = 0; i < run.count; ++i) {
        filled_.set(at[0] + static_cast<std::int32_t>(i), at[1], at[2]);
      }
    }
    const Eigen::Vector3d edge = grid.geometry.spacing / grid.geometry.spacing.minCoeff();
    // A voxel leaf gives the plane of the voxel that holds the point: up to half a diagonal less
    // deep than its centre.
    const double skin = kReachedDepth + (leaf == LeafModel::Voxel ? 0.5 * edge.norm() : 0.0);
    skinSquare_ = static_cast<float>((skin + 0.5) * (skin + 0.5));
  }

  [[nodiscard]] std::vector<bool> fillable() {
    BandedDistance whole(solid_, palette_), filled(filled_, palette_);
    std::vector<float> before, after;
    for (std::int32_t k = 0; k < dims_[2]; k += kSlab) {
      const std::int32_t end = std::min(k + kSlab, dims_[2]);
      first_ = std::max(k - 1, 0);
      whole.slab(first_, std::min(end + 1, dims_[2]), before);
      filled.slab(first_, std::min(end + 1, dims_[2]), after);
      before_ = before.data();
      after_ = after.data();
      tbb::parallel_for(tbb::blocked_range<std::int32_t>(k, end), [this](const auto& slices) {
        for (std::int32_t z = slices.begin(); z != slices.end(); ++z) checkSlice(z);
      });
    }
    std::vector<bool> fillable = wanted_;
    for (std::size_t c = 0; c < fillable.size(); ++c) {
      if (kept_[c].load()) fillable[c] = false;
    }
    return fillable;
  }

 private:
  [[nodiscard]] static VoxelBits bitsOf(const LabelGrid& grid, const SolidLabels& solid) {
    std::array<std::uint8_t, 256> wanted{};
    for (std::size_t value = 1; value < wanted.size(); ++value) wanted[value] = solid[value];
    return packBits(grid.geometry.dims, grid.labels, wanted);
  }
  [[nodiscard]] Extent3 voxelOf(std::size_t at) const {
    const auto nx = static_cast<std::size_t>(dims_[0]), ny = static_cast<std::size_t>(dims_[1]);
    return {static_cast<std::int32_t>(at % nx), static_cast<std::int32_t>(at / nx % ny),
            static_cast<std::int32_t>(at / (nx * ny))};
  }
  [[nodiscard]] std::size_t indexOf(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(dims_[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(dims_[0]) +
           static_cast<std::size_t>(i);
  }

  void checkSlice(std::int32_t k) {
    std::size_t at = indexOf(0, 0, k - first_);
    for (std::int32_t j = 0; j < dims_[1]; ++j) {
      for (std::int32_t i = 0; i < dims_[0]; ++i, ++at) {
        if (after_[at] > 0.0f || before_[at] == after_[at]) continue;  // outside, or unchanged
        if (!isRead(i, j, k)) continue;
        if (before_[at] > 0.0f) {
          keep(i, j, k);
        } else {
          keepAround({i, j, k}, -after_[at]);
        }
      }
    }
  }

  /// Does a contact less deep than the skin read this voxel? It does where one of the voxels around
  /// it, or it itself, is outside or in the skin.
  [[nodiscard]] bool isRead(std::int32_t i, std::int32_t j, std::int32_t k) const {
    for (std::int32_t z = std::max(k - 1, 0); z < std::min(k + 2, dims_[2]); ++z) {
      for (std::int32_t y = std::max(j - 1, 0); y < std::min(j + 2, dims_[1]); ++y) {
        const float* row = after_ + indexOf(0, y, z - first_);
        for (std::int32_t x = std::max(i - 1, 0); x < std::min(i + 2, dims_[0]); ++x) {
          if (row[x] > -skinSquare_) return true;
        }
      }
    }
    return false;
  }

  void keep(std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::size_t at = indexOf(i, j, k);
    auto run = std::upper_bound(cavities_.runs.begin(), cavities_.runs.end(), at,
                                [](std::size_t a, const CavityRun& r) { return a < r.first; });
    kept_[(--run)->cavity].store(true);
  }

  /// Every cavity to fill with a voxel nearer than the nearest one outside.
  void keepAround(const Extent3& q, float square) {
    Extent3 lo, hi;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto reach = static_cast<std::int32_t>(std::sqrt(square / palette_.weight()[a])) + 1;
      lo[a] = std::max(q[a] - reach, 0);
      hi[a] = std::min(q[a] + reach + 1, dims_[a]);
    }
    for (std::int32_t z = lo[2]; z < hi[2]; ++z) {
      for (std::int32_t y = lo[1]; y < hi[1]; ++y) {
        for (std::int32_t x = lo[0]; x < hi[0]; ++x) {
          if (solid_.test(x, y, z) || !filled_.test(x, y, z)) continue;
          const auto part = [&](std::size_t a, std::int32_t v) {
            const auto steps = static_cast<float>(v - q[a]);
            return steps * steps * palette_.weight()[a];
          };
          if (part(0, x) + part(1, y) + part(2, z) < square) keep(x, y, z);
        }
      }
    }
  }

  const Extent3 dims_;
  const SealedCavities& cavities_;
  const std::vector<bool>& wanted_;
  const DepthPalette palette_;
  VoxelBits solid_, filled_;
  float skinSquare_ = 0.0f;
  std::int32_t first_ = 0;         // slice where before_ and after_ begin
  const float* before_ = nullptr;  // signed squares, > 0 outside
  const float* after_ = nullptr;
  std::vector<std::atomic<bool>> kept_;
};

}  // namespace

SealedCavities findSealedCavities(const LabelGrid& grid, const SolidLabels& solid) {
  return FreeSpace(grid, solid).cavities();
}

std::vector<bool> fillableCavities(const LabelGrid& grid, const SolidLabels& solid,
                                   const SealedCavities& cavities, std::vector<bool> wanted,
                                   LeafModel leaf) {
  if (std::find(wanted.begin(), wanted.end(), true) == wanted.end()) return wanted;
  return FillCheck(grid, solid, cavities, wanted, leaf).fillable();
}

}  // namespace palpate
