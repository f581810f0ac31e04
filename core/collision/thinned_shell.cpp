#include "core/collision/thinned_shell.h"

#include <algorithm>

namespace palpate {
namespace {

class Thinning {
 public:
  explicit Thinning(const ShellHierarchy& shell) : shell_(shell) {}

  void toBound(std::size_t level, std::size_t node, double bound) {
    const std::size_t first = node * ShellHierarchy::pointsPerNode(level);
    const std::size_t last = std::min(first + ShellHierarchy::pointsPerNode(level), shell_.size());
    const std::size_t best = standIn(shell_.level[level][node], first, last);
    if (farthest2(best, first, last) <= bound * bound) return keep(best, last - first > 1);
    if (level == 0) {
      for (std::size_t rank = first; rank < last; ++rank) keep(rank, false);
      return;
    }
    const std::size_t child = node * ShellHierarchy::kArity;
    const std::size_t end =
        std::min(child + ShellHierarchy::kArity, shell_.level[level - 1].size());
    for (std::size_t c = child; c < end; ++c) toBound(level - 1, c, bound);
  }

  void toLevel(std::size_t level) {
    const std::size_t points = ShellHierarchy::pointsPerNode(level);
    for (std::size_t node = 0; node < shell_.level[level].size(); ++node) {
      const std::size_t last = std::min((node + 1) * points, shell_.size());
      keep(standIn(shell_.level[level][node], node * points, last), last - node * points > 1);
    }
  }

  [[nodiscard]] ThinnedShell build(const ShellBlocks& blocks) const {
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t rank : kept_) points.push_back(point(rank));
    ThinnedShell thinned;
    thinned.hierarchy = buildShellHierarchy(points);
    for (std::uint32_t& order : thinned.hierarchy.order) {
      thinned.standsForMore.push_back(more_[order]);
      order = shell_.order[kept_[order]];
    }
    thinned.blocks = buildShellBlocks(thinned.hierarchy, blocks.middle);
    return thinned;
  }

 private:
  [[nodiscard]] Eigen::Vector3d point(std::size_t rank) const {
    return {shell_.x[rank], shell_.y[rank], shell_.z[rank]};
  }
  [[nodiscard]] std::size_t standIn(const ShellSphere& sphere, std::size_t first,
                                    std::size_t last) const {
    const Eigen::Vector3d centre(sphere.c);
    std::size_t best = first;
    double least = (point(first) - centre).squaredNorm();
    for (std::size_t rank = first + 1; rank < last; ++rank) {
      const double d2 = (point(rank) - centre).squaredNorm();
      if (d2 > least || (d2 == least && shell_.order[rank] > shell_.order[best])) continue;
      best = rank;
      least = d2;
    }
    return best;
  }
  [[nodiscard]] double farthest2(std::size_t from, std::size_t first, std::size_t last) const {
    double most = 0.0;
    for (std::size_t rank = first; rank < last; ++rank) {
      most = std::max(most, (point(rank) - point(from)).squaredNorm());
    }
    return most;
  }
  void keep(std::size_t rank, bool more) {
    kept_.push_back(rank);
    more_.push_back(more ? 1 : 0);
  }

  const ShellHierarchy& shell_;
  std::vector<std::size_t> kept_;   // ranks
  std::vector<std::uint8_t> more_;  // beside it
};

}  // namespace

ThinnedShell thinToBound(const ShellHierarchy& shell, const ShellBlocks& blocks, double bound) {
  Thinning thinning(shell);
  thinning.toBound(shell.level.size() - 1, 0, bound);
  return thinning.build(blocks);
}

std::shared_ptr<const ThinnedShell> ThinnedShells::toBound(const ShellHierarchy& shell,
                                                           const ShellBlocks& blocks,
                                                           double bound) {
  const std::lock_guard<std::mutex> lock(access_);
  auto& made = byBound_[bound];
  if (made == nullptr)
    made = std::make_shared<const ThinnedShell>(thinToBound(shell, blocks, bound));
  return made;
}

ThinnedShell thinToLevel(const ShellHierarchy& shell, const ShellBlocks& blocks,
                         std::size_t level) {
  Thinning thinning(shell);
  thinning.toLevel(level);
  return thinning.build(blocks);
}

}  // namespace palpate
