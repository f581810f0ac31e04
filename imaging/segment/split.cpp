/// Shares a label among seeds by flooding.
///
/// Source: Meyer, "Topographic distance and watershed lines", 1994: the lowest voxel beside a basin
/// joins it next, and never below the level that the flood has reached. Here the flood stays within
/// the label, so that it costs memory for its front only.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "imaging/segment/apply.h"
#include "imaging/segment/edit.h"

namespace palpate {
namespace {

struct Front {
  double level = 0.0;
  std::uint64_t order = 0;
  std::array<std::int32_t, 3> voxel{0, 0, 0};
  std::uint8_t seed = 0;
  bool operator>(const Front& o) const {
    return level != o.level ? level > o.level : order > o.order;
  }
};

/// Steepness of the grey values, per mm; one-sided at the edge of the scan.
double steepness(const Edit& edit, const std::array<std::int32_t, 3>& v) {
  const GridGeometry& g = edit.geometry();
  const Eigen::Vector3d spacing = spacing_mm(g);
  double sum = 0.0;
  for (std::size_t d = 0; d < 3; ++d) {
    auto a = v, b = v;
    a[d] = std::max(0, v[d] - 1);
    b[d] = std::min(g.dims[d] - 1, v[d] + 1);
    if (a[d] == b[d]) continue;
    const double slope = (edit.volume.value(g.index(b[0], b[1], b[2])) -
                          edit.volume.value(g.index(a[0], a[1], a[2]))) /
                         ((b[d] - a[d]) * spacing[static_cast<Eigen::Index>(d)]);
    sum += slope * slope;
  }
  return std::sqrt(sum);
}

double levelOf(const Edit& edit, tool::Split::By by, const std::array<std::int32_t, 3>& v) {
  if (by == tool::Split::By::Edges) return steepness(edit, v);
  return -edit.volume.value(edit.geometry().index(v[0], v[1], v[2]));
}

/// The flood: kMask is what is to be shared, kA what is taken. Seeds' numbers go into `owner`.
class Flood {
 public:
  Flood(const Edit& edit, tool::Split::By by, MaskBlock& block)
      : edit_(edit), by_(by), block_(block) {}

  /// A voxel of the grid that the seed starts from, with those around it; false where the label is
  /// not. A seed is no barrier: whatever its own value, its neighbours come at theirs.
  bool start(const std::array<std::int32_t, 3>& v, std::uint8_t seed, double radius_mm) {
    if (!within(v) || (at(v) & plane::kMask) == 0) return false;
    const GridGeometry& g = edit_.geometry();
    const VoxelBox around = grownBy({v, v}, radius_mm, g);
    const double radius2 = radius_mm * radius_mm * (1.0 + 1e-9);
    for (std::int32_t z = around.low[2]; z <= around.high[2]; ++z) {
      for (std::int32_t y = around.low[1]; y <= around.high[1]; ++y) {
        for (std::int32_t x = around.low[0]; x <= around.high[0]; ++x) {
          const Eigen::Array3d apart(x - v[0], y - v[1], z - v[2]);
          if ((apart * spacing_mm(g).array()).square().sum() > radius2) continue;
          const std::array near{x, y, z};
          if (!within(near) || (at(near) & (plane::kMask | plane::kA)) != plane::kMask) continue;
          take(near, seed, -std::numeric_limits<double>::infinity());
        }
      }
    }
    return true;
  }

  /// `taken(voxel of the grid, seed)` for every voxel reached. False when cancelled.
  bool run(std::uint64_t voxels,
           const std::function<void(const std::array<std::int32_t, 3>&, std::uint8_t)>& taken) {
    std::uint64_t done = 0;
    const Share share = edit_.share("Flooding from the seeds");
    while (!front_.empty()) {
      const Front next = front_.top();
      front_.pop();
      taken(next.voxel, next.seed);
      if ((++done & 0xffffU) == 0) {
        if (edit_.progress.cancelled()) return false;
        share.at(static_cast<double>(done) / static_cast<double>(voxels));
      }
      visitNeighbours(next);
    }
    return true;
  }

 private:
  [[nodiscard]] bool within(const std::array<std::int32_t, 3>& v) const {
    for (std::size_t d = 0; d < 3; ++d) {
      if (v[d] < block_.box.low[d] || v[d] > block_.box.high[d]) return false;
    }
    return true;
  }
  [[nodiscard]] std::uint8_t& at(const std::array<std::int32_t, 3>& v) {
    const auto& low = block_.box.low;
    return block_.voxels[block_.index(v[0] - low[0], v[1] - low[1], v[2] - low[2])];
  }
  void take(const std::array<std::int32_t, 3>& v, std::uint8_t seed, double level) {
    at(v) |= plane::kA;
    front_.push({level, order_++, v, seed});
  }
  void visitNeighbours(const Front& from) {
    for (std::int32_t dz = -1; dz <= 1; ++dz) {
      for (std::int32_t dy = -1; dy <= 1; ++dy) {
        for (std::int32_t dx = -1; dx <= 1; ++dx) {
          const std::array v{from.voxel[0] + dx, from.voxel[1] + dy, from.voxel[2] + dz};
          if (!within(v) || (at(v) & (plane::kMask | plane::kA)) != plane::kMask) continue;
          take(v, from.seed, std::max(from.level, levelOf(edit_, by_, v)));
        }
      }
    }
  }

  const Edit& edit_;
  tool::Split::By by_;
  MaskBlock& block_;
  std::priority_queue<Front, std::vector<Front>, std::greater<>> front_;
  std::uint64_t order_ = 0;
};

Result<void> check(const tool::Split& tool) {
  const bool bare =
      std::any_of(tool.seeds.begin(), tool.seeds.end(),
                  [](const tool::Split::Seeds& seeds) { return seeds.points_mm.empty(); });
  if (tool.seeds.empty() || bare) {
    return fail(usageError("There is no seed to split by.")
                    .inField("seeds")
                    .wants("points in every part")
                    .advise("Click on each part."));
  }
  if (auto fits = within(tool.radius_mm, 0.0, 50.0, "radius_mm"); !fits) return fits;
  if (tool.seeds.size() > 250) {
    return fail(usageError("There are too many parts.").inField("seeds").wants("at most 250"));
  }
  return {};
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::Split& tool) {
  if (auto fits = check(tool); !fits) return fits;
  MaskBlock block = blockOf(edit.labels, edit.value, boundsOf(edit.labels, edit.value));
  const auto voxels = static_cast<std::uint64_t>(
      std::count_if(block.voxels.begin(), block.voxels.end(), [](auto v) { return v != 0; }));
  Flood flood(edit, tool.by, block);
  std::vector<std::uint8_t> values;
  for (std::size_t s = 0; s < tool.seeds.size(); ++s) {
    const tool::Split::Seeds& seeds = tool.seeds[s];
    const std::string field = "seeds[" + std::to_string(s) + "]";
    const auto row = rowFor(seeds.label, edit.table);
    if (!row) return fail(Error(row.error()).inField(field + ".label"));
    values.push_back(row->value);
    for (std::size_t i = 0; i < seeds.points_mm.size(); ++i) {
      const std::string at = field + ".points[" + std::to_string(i) + "]";
      const auto voxel = voxelOf(edit, seeds.points_mm[i], at);
      if (!voxel) return fail(voxel.error());
      if (!flood.start(*voxel, static_cast<std::uint8_t>(s), tool.radius_mm)) {
        return fail(inputRefused("The seed is not on the label that is split.")
                        .inField(at)
                        .wants("a point of the label")
                        .advise("Click on the label itself."));
      }
    }
  }
  const bool finished =
      flood.run(voxels, [&](const std::array<std::int32_t, 3>& v, std::uint8_t s) {
        const std::size_t i = edit.geometry().index(v[0], v[1], v[2]);
        if (edit.mayChange(i)) edit.labels.labels[i] = values[s];
      });
  if (!finished) return fail(cancelled());
  return {};
}

}  // namespace palpate
