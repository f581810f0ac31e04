/// core/collision itself, through its public header.

#include <cstdlib>

#include "core/collision/contact_finder.h"
#include "tests/benchmarks/wide_peers.h"

namespace palpate::bench {
namespace {

TreeOptions treeOptions(const std::string& method) {
  TreeOptions options;
  if (method == "voxel") options.leaf = LeafModel::Voxel;
  return options;
}

QueryOptions queryOptions(const std::string& method) {
  QueryOptions options;
  if (method == "paper") options.method = QueryMethod::Paper;
  const std::size_t equals = method.find('=');
  if (equals == std::string::npos) return options;
  const std::string key = method.substr(0, equals);
  const double value = std::atof(method.c_str() + equals + 1);
  if (key == "threads") options.threads = static_cast<int>(value);
  if (key == "contact_budget") options.contactBudget = static_cast<std::uint32_t>(value);
  if (key == "coherence") options.coherence = method.substr(equals + 1) == "on";
  if (key == "perceptual_mm") options.perceptualBound = value * 1e-3;
  return options;
}

class PalpatePeer : public Peer {
 public:
  PalpatePeer(const LabelGrid& grid, const std::vector<Eigen::Vector3d>& points,
              const std::string& method)
      : name_(method == "hierarchy" ? "palpate" : "palpate, " + method),
        tree_(VoxelTree::build(grid, {}, treeOptions(method)).value()),
        shell_(PointShell::fromPoints(points, {points.size(), Eigen::Vector3d::UnitZ()}).value()),
        finder_(tree_, shell_, queryOptions(method)),
        perVoxel_(static_cast<float>(1.0 / grid.geometry.spacing.minCoeff())) {}
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::size_t worldBytes() const override {
    return tree_.stats().topologyBytes + tree_.stats().payloadBytes;
  }
  [[nodiscard]] std::size_t tests() const override { return result_.tests; }
  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    result_ = finder_.findPacked(X_VT);
    out.count = result_.contactCount;
  }
  void collect(ContactList& out) const override {
    const PackedContacts& packed = finder_.packed();
    for (std::size_t i = 0; i < out.count; ++i) {
      out.index[i] = packed.index[i];
      out.depth[i] = packed.depth[i] * perVoxel_;
      out.nx[i] = packed.nx[i];
      out.ny[i] = packed.ny[i];
      out.nz[i] = packed.nz[i];
    }
  }

 private:
  std::string name_;
  VoxelTree tree_;
  PointShell shell_;
  ContactFinder finder_;
  QueryResult result_;
  float perVoxel_;
};

}  // namespace

std::unique_ptr<Peer> makePalpate(const LabelGrid& grid,
                                  const std::vector<Eigen::Vector3d>& points_T,
                                  const std::string& method) {
  return std::make_unique<PalpatePeer>(grid, points_T, method);
}

}  // namespace palpate::bench
