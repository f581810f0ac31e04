#pragma once
/// Some points of a shell that stand for all of it: one for each node where descent stops. Internal
/// to ContactFinder.
///
/// Which nodes those are does not depend on the pose. So where descent stops is decided once, when
/// the finder is made, and the points that stand for nodes get a hierarchy of their own: its leaves
/// are full again, and every method of the finder runs on it as on any shell.
///
/// The stand-in of a node is its point nearest to the centre of the node's sphere (ties: the lower
/// shell index).

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "core/collision/shell_hierarchy.h"

namespace palpate {

struct ThinnedShell {
  ShellHierarchy hierarchy;  ///< Rank -> index in the whole shell.
  ShellBlocks blocks;        ///< About the whole shell's middle: every point keeps its bits.
  std::vector<std::uint8_t> standsForMore;  ///< By rank: does it stand for more than itself?
};

/// One point for every node whose points all lie within `bound` metres of its stand-in (the highest
/// such node on the way down), and every point that is in none.
[[nodiscard]] ThinnedShell thinToBound(const ShellHierarchy& shell, const ShellBlocks& blocks,
                                       double bound);

/// Of one shell, what thinToBound() made for the finders so far: finders of the same bound share
/// it. Any thread; not for the loops.
class ThinnedShells {
 public:
  [[nodiscard]] std::shared_ptr<const ThinnedShell> toBound(const ShellHierarchy& shell,
                                                            const ShellBlocks& blocks,
                                                            double bound);

 private:
  std::mutex access_;
  std::map<double, std::shared_ptr<const ThinnedShell>> byBound_;
};

/// One point for every node of a level.
[[nodiscard]] ThinnedShell thinToLevel(const ShellHierarchy& shell, const ShellBlocks& blocks,
                                       std::size_t level);

}  // namespace palpate
