#include "core/collision/candidate_boxes.h"

#include "core/voxels/node_mask.h"

namespace palpate {
namespace {

template <int Bits>
class Listing {
 public:
  Listing(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& c, double below,
          const Vec3& u, double offset, CandidateBoxes& out) noexcept
      : tree_(tree), boxes_(boxes), c_(c), below_(below), u_(u), offset_(offset), out_(out) {}

  std::uint32_t run() noexcept {
    out_.count = 0;
    out_.full = false;
    out_.front = std::numeric_limits<double>::infinity();
    listFrom(tree_.levels, 0, {0, 0, 0});
    return nodesVisited_;
  }

 private:
  // The least u·x of a box; without a plane everything is before it.
  [[nodiscard]] double leastAlong(const OccupiedBox& box) const noexcept {
    double least = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      least += u_.v[a] * boxes_.face[a][u_.v[a] > 0.0 ? box.lo[a] : box.hi[a]];
    }
    return least;
  }

  void listFrom(int level, std::uint32_t node, const VoxelIndex& corner) noexcept {
    ++nodesVisited_;
    const TreeLevel& at = tree_.level[static_cast<std::size_t>(level)];
    const int shift = Bits * (level - 1);
    const auto mask = NodeMask<Bits>::load(at.masks.data(), node);
    const SlabDistances<Bits> slab = slabDistances<Bits>(boxes_, c_, corner, shift);
    forEachCloser(mask, slab, below_, [&](int child, double) {
      if (out_.full) return;
      const VoxelIndex lower = childCorner<Bits>(corner, child, shift);
      if (level == 1) return add(lower);
      const std::uint32_t below = childNode(at, node, mask, child);
      const OccupiedBox& box = boxes_.occupied[static_cast<std::size_t>(level - 1)][below];
      if (!(squaredTo(boxes_, box, c_) < below_) || leastAlong(box) > offset_) return;
      listFrom(level - 1, below, lower);
    });
  }

  void add(const VoxelIndex& voxel) noexcept {
    const double least = leastAlong(boxOfVoxel(voxel));
    if (least > offset_) return;
    out_.full = out_.count == CandidateBoxes::kRoom;
    if (out_.full) return;
    out_.front = std::min(out_.front, least);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(voxel[a]);
      out_.lower[a][out_.count] = boxes_.face[a][i];
      out_.upper[a][out_.count] = boxes_.face[a][i + 1];
    }
    ++out_.count;
  }

  const VoxelTree::Data& tree_;
  const OccupiedBoxes& boxes_;
  Vec3 c_;
  double below_;  // squared
  Vec3 u_;
  double offset_;
  CandidateBoxes& out_;
  std::uint32_t nodesVisited_ = 0;
};

}  // namespace

template <int Bits>
std::uint32_t listCandidates(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& c,
                             double below, const Vec3& u, double offset,
                             CandidateBoxes& out) noexcept {
  return Listing<Bits>(tree, boxes, c, below, u, offset, out).run();
}

template std::uint32_t listCandidates<1>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                         double, const Vec3&, double, CandidateBoxes&) noexcept;
template std::uint32_t listCandidates<2>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                         double, const Vec3&, double, CandidateBoxes&) noexcept;
template std::uint32_t listCandidates<3>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                         double, const Vec3&, double, CandidateBoxes&) noexcept;

}  // namespace palpate
