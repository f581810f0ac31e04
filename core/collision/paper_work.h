#pragma once
/// What QueryMethod::Paper keeps between queries. Internal.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/collision/body_tree.h"
#include "core/voxels/pattern_spheres.h"

namespace palpate {

/// In V, metres.
struct PaperSphere {
  double c[3] = {0, 0, 0};
  double r = 0;
};

/// A node on the way down. Level 0 ends a tree: an item of the world, a point of the tool.
struct TreeNode {
  std::uint32_t index = 0;  ///< Among the nodes of its level.
  /// In nodes of its level; the hierarchy over a shell's points has none.
  std::array<std::int32_t, 3> address{0, 0, 0};
  std::int32_t level = 0;
};

/// A node of the tool against a node of the world.
struct NodePair {
  TreeNode tool, world;
};

struct PaperWork {
  const VoxelBody* body = nullptr;  ///< None: the tool's tree is the hierarchy over its points.
  PatternSpheres worldSpheres, bodySpheres;
  std::vector<NodePair> pairs, nextPairs;  ///< The frontier, and the next.
  struct Child {
    TreeNode node;
    PaperSphere sphere;
  };
  std::vector<Child> children;  ///< Of one node of the world.
};

}  // namespace palpate
