/// core/collision itself, through its public header.

#include "core/collision/contact_finder.h"
#include "tests/benchmarks/wide_peers.h"

namespace palpate::bench {
namespace {

class PalpatePeer : public Peer {
 public:
  PalpatePeer(const LabelGrid& grid, const std::vector<Eigen::Vector3d>& points,
              const std::string& method)
      : method_(method),
        tree_(VoxelTree::build(grid, {}, {}).value()),
        shell_(PointShell::fromPoints(points, {points.size(), Eigen::Vector3d::UnitZ()}).value()),
        finder_(tree_, shell_, options(method)),
        contacts_(points.size()),
        perVoxel_(1.0 / grid.geometry.spacing.minCoeff()) {}
  [[nodiscard]] std::string name() const override { return "palpate, " + method_; }
  [[nodiscard]] std::size_t worldBytes() const override {
    return tree_.stats().topologyBytes + tree_.stats().payloadBytes;
  }
  [[nodiscard]] std::size_t tests() const override { return result_.tests; }
  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    result_ = finder_.find(X_VT, contacts_);
    out.count = result_.contactCount;
  }
  void collect(ContactList& out) const override {
    for (std::size_t i = 0; i < out.count; ++i) {
      const Contact& c = contacts_[i];
      out.index[i] = c.shellIndex;
      out.depth[i] = static_cast<float>(c.depth * perVoxel_);
      out.nx[i] = static_cast<float>(c.n[0]);
      out.ny[i] = static_cast<float>(c.n[1]);
      out.nz[i] = static_cast<float>(c.n[2]);
    }
  }

 private:
  static QueryOptions options(const std::string& method) {
    QueryOptions o;
    o.method = method == "paper" ? QueryMethod::Paper : QueryMethod::Hierarchy;
    return o;
  }
  std::string method_;
  VoxelTree tree_;
  PointShell shell_;
  ContactFinder finder_;
  std::vector<Contact> contacts_;
  QueryResult result_;
  double perVoxel_;
};

}  // namespace

std::unique_ptr<Peer> makePalpate(const LabelGrid& grid,
                                  const std::vector<Eigen::Vector3d>& points_T,
                                  const std::string& method) {
  return std::make_unique<PalpatePeer>(grid, points_T, method);
}

}  // namespace palpate::bench
