/// OpenVDB: a narrow-band level set (three voxels each side), read at the eight corners of a
/// point's cell through a value accessor. Depth is clamped at three voxels.

#include "tests/benchmarks/wide_peers.h"

#ifdef PALPATE_BENCH_OPENVDB
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>

namespace palpate::bench {
namespace {

class OpenVdbPeer : public Peer {
 public:
  OpenVdbPeer(const DenseField& field, const std::vector<Eigen::Vector3d>& points)
      : points_(points), spacing_(field.unit), dims_(field.dims) {
    openvdb::initialize();
    constexpr float kBand = 3.0f;
    grid_ = openvdb::FloatGrid::create(kBand);
    grid_->setGridClass(openvdb::GRID_LEVEL_SET);
    auto write = grid_->getAccessor();
    for (int k = 0; k < dims_[2]; ++k) {
      for (int j = 0; j < dims_[1]; ++j) {
        for (int i = 0; i < dims_[0]; ++i) {
          const float v = field.at(i, j, k);
          if (std::abs(v) < kBand) write.setValue({i, j, k}, v);
        }
      }
    }
    openvdb::tools::signedFloodFill(grid_->tree());
  }
  [[nodiscard]] std::string name() const override { return "OpenVDB level set"; }
  [[nodiscard]] std::string remark() const override { return "depth clamped at 3 voxels"; }
  [[nodiscard]] std::size_t worldBytes() const override { return grid_->memUsage(); }
  [[nodiscard]] std::size_t tests() const override { return points_.size(); }

  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    const auto read = grid_->getConstAccessor();
    out.count = 0;
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const Eigen::Vector3d u = X_VT * points_[n] / spacing_;
      if (!(u.x() >= 0 && u.y() >= 0 && u.z() >= 0 && u.x() < dims_[0] - 1 &&
            u.y() < dims_[1] - 1 && u.z() < dims_[2] - 1)) {
        continue;
      }
      const openvdb::Coord at(static_cast<int>(u.x()), static_cast<int>(u.y()),
                              static_cast<int>(u.z()));
      float v[8];
      for (int c = 0; c < 8; ++c) {
        v[c] = read.getValue(at.offsetBy(c & 1, c >> 1 & 1, c >> 2));
      }
      const auto mix = [](float a, float b, float t) { return a + (b - a) * t; };
      const float fx = static_cast<float>(u.x()) - static_cast<float>(at.x());
      const float fy = static_cast<float>(u.y()) - static_cast<float>(at.y());
      const float fz = static_cast<float>(u.z()) - static_cast<float>(at.z());
      const float r[4] = {mix(v[0], v[1], fx), mix(v[2], v[3], fx), mix(v[4], v[5], fx),
                          mix(v[6], v[7], fx)};
      const float s[2] = {mix(r[0], r[1], fy), mix(r[2], r[3], fy)};
      const float value = mix(s[0], s[1], fz);
      if (!(value < 0.0f)) continue;
      const float g[3] = {
          mix(mix(v[1] - v[0], v[3] - v[2], fy), mix(v[5] - v[4], v[7] - v[6], fy), fz),
          mix(r[1] - r[0], r[3] - r[2], fz), s[1] - s[0]};
      const float length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
      const float scale = length > 1e-9f ? 1.0f / length : 0.0f;
      out.index[out.count] = static_cast<std::uint32_t>(n);
      out.depth[out.count] = -value;
      out.nx[out.count] = g[0] * scale;
      out.ny[out.count] = g[1] * scale;
      out.nz[out.count] = g[2] * scale;
      ++out.count;
    }
  }

 private:
  const std::vector<Eigen::Vector3d>& points_;
  double spacing_;
  std::array<std::int32_t, 3> dims_;
  openvdb::FloatGrid::Ptr grid_;
};

}  // namespace

std::unique_ptr<Peer> makeOpenVdb(const DenseField& field,
                                  const std::vector<Eigen::Vector3d>& points_T) {
  return std::make_unique<OpenVdbPeer>(field, points_T);
}

}  // namespace palpate::bench
#else
namespace palpate::bench {
std::unique_ptr<Peer> makeOpenVdb(const DenseField& /*field*/,
                                  const std::vector<Eigen::Vector3d>& /*points_T*/) {
  return nullptr;
}
}  // namespace palpate::bench
#endif
