#include "core/collision/occupied_boxes.h"

#include <algorithm>

namespace palpate {
namespace {

std::vector<double> facesAlong(const VoxelTree::Data& tree, std::size_t axis) {
  const auto a = static_cast<Eigen::Index>(axis);
  const std::size_t padded = std::size_t{1} << (tree.bits * tree.levels);
  std::vector<double> face;
  for (std::size_t i = 0; i <= padded; ++i) {
    face.push_back(tree.origin[a] + static_cast<double>(i) * tree.geometry.spacing[a]);
  }
  return face;
}

// Fills in a node and all below it.
template <int Bits>
OccupiedBox fillOccupied(const VoxelTree::Data& tree, int level, std::uint32_t node,
                         const VoxelIndex& corner, OccupiedBoxes& out) {
  using Mask = NodeMask<Bits>;
  const TreeLevel& at = tree.level[static_cast<std::size_t>(level)];
  const int shift = Bits * (level - 1);
  std::uint32_t next = level > 1 ? at.firstChild[node] : 0;
  OccupiedBox box;
  box.lo.fill(0xFFFF);
  forEachChild(Mask::load(at.masks.data(), node), [&](int child) {
    const VoxelIndex lower = childCorner<Bits>(corner, child, shift);
    OccupiedBox part = boxOfVoxel(lower);
    if (level > 1) part = fillOccupied<Bits>(tree, level - 1, next++, lower, out);
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = std::min(box.lo[a], part.lo[a]);
      box.hi[a] = std::max(box.hi[a], part.hi[a]);
    }
  });
  return out.occupied[static_cast<std::size_t>(level)][node] = box;
}

}  // namespace

OccupiedBoxes occupiedBoxesOf(const VoxelTree::Data& tree) {
  OccupiedBoxes boxes;
  for (std::size_t a = 0; a < 3; ++a) boxes.face[a] = facesAlong(tree, a);
  for (const TreeLevel& level : tree.level) boxes.occupied.emplace_back(level.firstChild.size());
  switch (tree.bits) {
    case 1:
      (void)fillOccupied<1>(tree, tree.levels, 0, {0, 0, 0}, boxes);
      break;
    case 2:
      (void)fillOccupied<2>(tree, tree.levels, 0, {0, 0, 0}, boxes);
      break;
    default:
      (void)fillOccupied<3>(tree, tree.levels, 0, {0, 0, 0}, boxes);
      break;
  }
  return boxes;
}

}  // namespace palpate
