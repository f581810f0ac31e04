/// FCL with OctoMap: the solid voxels' octree against an octree of the shell's points, contacts on.
/// Its answer is pairs of boxes with FCL's own depths and normals, not points: a related question.

#include "tests/benchmarks/wide_peers.h"

#ifdef PALPATE_BENCH_FCL
#include <fcl/fcl.h>
#include <octomap/OcTree.h>

#include <algorithm>

namespace palpate::bench {
namespace {

std::shared_ptr<octomap::OcTree> emptyTree(double resolution) {
  auto tree = std::make_shared<octomap::OcTree>(resolution);
  tree->setOccupancyThres(0.5);
  return tree;
}

class FclPeer : public Peer {
 public:
  FclPeer(const LabelGrid& grid, const std::vector<Eigen::Vector3d>& points)
      : capacity_(points.size()) {
    const double s = grid.geometry.spacing.x();
    auto world = emptyTree(s);
    const auto& d = grid.geometry.dims;
    for (int k = 0; k < d[2]; ++k) {
      for (int j = 0; j < d[1]; ++j) {
        for (int i = 0; i < d[0]; ++i) {
          if (grid.at(i, j, k) == 0) continue;
          // OctoMap's cells start at multiples of the resolution: half a voxel off our centres.
          world->updateNode((i + 0.5) * s, (j + 0.5) * s, (k + 0.5) * s, true, true);
        }
      }
    }
    world->updateInnerOccupancy();
    world->prune();
    bytes_ = world->memoryUsage();
    auto tool = emptyTree(s);
    for (const Eigen::Vector3d& p : points) tool->updateNode(p.x(), p.y(), p.z(), true, true);
    tool->updateInnerOccupancy();
    shift_ = 0.5 * s;
    world_ = std::make_unique<fcl::CollisionObject<double>>(
        std::make_shared<fcl::OcTree<double>>(world));
    tool_ =
        std::make_unique<fcl::CollisionObject<double>>(std::make_shared<fcl::OcTree<double>>(tool));
  }
  [[nodiscard]] std::string name() const override { return "FCL octree pair"; }
  [[nodiscard]] std::string remark() const override { return "pairs of boxes, not points"; }
  [[nodiscard]] std::size_t worldBytes() const override { return bytes_; }

  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    Eigen::Isometry3d X = X_VT;
    X.translation() += Eigen::Vector3d::Constant(shift_);
    tool_->setTransform(X);
    fcl::CollisionRequest<double> request(1000000, true);
    fcl::CollisionResult<double> result;
    fcl::collide(world_.get(), tool_.get(), request, result);
    out.count = std::min(result.numContacts(), capacity_);
    for (std::size_t i = 0; i < out.count; ++i) {
      const auto& c = result.getContact(i);
      out.index[i] = static_cast<std::uint32_t>(i);
      out.depth[i] = static_cast<float>(c.penetration_depth);
      out.nx[i] = static_cast<float>(c.normal.x());
      out.ny[i] = static_cast<float>(c.normal.y());
      out.nz[i] = static_cast<float>(c.normal.z());
    }
  }

 private:
  std::size_t capacity_;
  std::size_t bytes_ = 0;
  double shift_ = 0;
  std::unique_ptr<fcl::CollisionObject<double>> world_, tool_;
};

}  // namespace

std::unique_ptr<Peer> makeFcl(const LabelGrid& grid, const std::vector<Eigen::Vector3d>& points_T) {
  return std::make_unique<FclPeer>(grid, points_T);
}

}  // namespace palpate::bench
#else
namespace palpate::bench {
std::unique_ptr<Peer> makeFcl(const LabelGrid& /*grid*/,
                              const std::vector<Eigen::Vector3d>& /*points_T*/) {
  return nullptr;
}
}  // namespace palpate::bench
#endif
