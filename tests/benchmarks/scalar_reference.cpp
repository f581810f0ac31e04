#include <algorithm>
#include <cmath>

#include "tests/benchmarks/dense_peers.h"

namespace palpate::bench {
namespace {

class ScalarReference : public Peer {
 public:
  ScalarReference(const DenseField& field, const std::vector<Eigen::Vector3d>& points)
      : field_(field), points_(points) {}
  [[nodiscard]] std::string name() const override { return "scalar, every point"; }
  [[nodiscard]] std::size_t worldBytes() const override {
    return field_.value.size() * sizeof(float);
  }
  [[nodiscard]] std::size_t tests() const override { return points_.size(); }

  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    out.count = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) test(X_VT * points_[i], i, out);
  }

 private:
  void test(const Eigen::Vector3d& p_V, std::size_t i, ContactList& out) const {
    std::int32_t cell[3];
    double f[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const double u = p_V[static_cast<Eigen::Index>(a)] / field_.spacing[a];
      const std::int32_t last = field_.dims[a] - 1;
      if (!(u >= 0.0 && u <= last)) return;
      cell[a] = std::min(static_cast<std::int32_t>(u), last - 1);
      f[a] = u - cell[a];
    }
    double v[2][2][2];
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 2; ++x) v[z][y][x] = field_.at(cell[0] + x, cell[1] + y, cell[2] + z);
      }
    }
    const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
    double g[3] = {0, 0, 0};
    double row[2][2];
    for (int z = 0; z < 2; ++z) {
      for (int y = 0; y < 2; ++y) row[z][y] = mix(v[z][y][0], v[z][y][1], f[0]);
    }
    const double value =
        mix(mix(row[0][0], row[0][1], f[1]), mix(row[1][0], row[1][1], f[1]), f[2]);
    if (!(value < 0.0)) return;
    g[0] = mix(mix(v[0][0][1] - v[0][0][0], v[0][1][1] - v[0][1][0], f[1]),
               mix(v[1][0][1] - v[1][0][0], v[1][1][1] - v[1][1][0], f[1]), f[2]);
    g[1] = mix(row[0][1] - row[0][0], row[1][1] - row[1][0], f[2]);
    g[2] = mix(row[1][0] - row[0][0], row[1][1] - row[0][1], f[1]);
    for (std::size_t a = 0; a < 3; ++a) g[a] *= field_.unit / field_.spacing[a];
    const double length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const bool any = length > 1e-9;
    out.index[out.count] = static_cast<std::uint32_t>(i);
    out.depth[out.count] = static_cast<float>(-value);
    out.nx[out.count] = any ? static_cast<float>(g[0] / length) : 0.0f;
    out.ny[out.count] = any ? static_cast<float>(g[1] / length) : 0.0f;
    out.nz[out.count] = any ? static_cast<float>(g[2] / length) : 1.0f;
    ++out.count;
  }

  const DenseField& field_;
  const std::vector<Eigen::Vector3d>& points_;
};

}  // namespace

std::unique_ptr<Peer> makeScalarReference(const DenseField& field,
                                          const std::vector<Eigen::Vector3d>& points_T) {
  return std::make_unique<ScalarReference>(field, points_T);
}

}  // namespace palpate::bench
