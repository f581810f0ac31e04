/// Bullet: its signed distance field (btMiniSDF, cells of 32 nodes and cubic shape functions),
/// given our field's trilinear values, asked for every point. Up to 128^3: beyond that it needs
/// gigabytes.

#include "tests/benchmarks/wide_peers.h"

#ifdef PALPATE_BENCH_BULLET
#include <BulletCollision/CollisionShapes/btMiniSDF.h>

#include <array>
#include <cmath>

namespace palpate::bench {
namespace {

constexpr int kMostSide = 128;

// Where in the unit cell (coordinates -1, -1/3, 1/3, 1) each of the 32 shape functions is one.
std::array<std::array<double, 3>, 32> nodePlaces(const btMiniSDF& sdf) {
  std::array<std::array<double, 3>, 32> places{};
  const double at[4] = {-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0};
  for (double x : at) {
    for (double y : at) {
      for (double z : at) {
        const int edges = (std::abs(x) == 1.0) + (std::abs(y) == 1.0) + (std::abs(z) == 1.0);
        if (edges < 2) continue;
        const btShapeMatrix n = sdf.shape_function_(btVector3(
            static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z)));
        for (int i = 0; i < 32; ++i) {
          if (n[i] > 0.99) places[static_cast<std::size_t>(i)] = {x, y, z};
        }
      }
    }
  }
  return places;
}

class BulletPeer : public Peer {
 public:
  BulletPeer(const DenseField& field, const std::vector<Eigen::Vector3d>& points)
      : points_(points), spacing_(field.unit) {
    const auto places = nodePlaces(sdf_);
    const auto& d = field.dims;
    sdf_.m_domain = btAlignedBox3d(btVector3(0, 0, 0), btVector3(static_cast<btScalar>(d[0] - 1),
                                                                 static_cast<btScalar>(d[1] - 1),
                                                                 static_cast<btScalar>(d[2] - 1)));
    for (std::size_t a = 0; a < 3; ++a) sdf_.m_resolution[a] = static_cast<unsigned>(d[a] - 1);
    sdf_.m_cell_size = btVector3(1, 1, 1);
    sdf_.m_inv_cell_size = btVector3(1, 1, 1);
    sdf_.m_n_fields = 1;
    const int count = (d[0] - 1) * (d[1] - 1) * (d[2] - 1);
    sdf_.m_n_cells = static_cast<std::size_t>(count);
    sdf_.m_nodes.resize(1);
    sdf_.m_cells.resize(1);
    sdf_.m_cell_map.resize(1);
    sdf_.m_nodes[0].resize(count * 32);
    sdf_.m_cells[0].resize(count);
    sdf_.m_cell_map[0].resize(count);
    // Every cell has nodes of its own: simpler than Bullet's generator, and kinder to the cache.
    int cell = 0;
    for (int k = 0; k < d[2] - 1; ++k) {
      for (int j = 0; j < d[1] - 1; ++j) {
        for (int i = 0; i < d[0] - 1; ++i, ++cell) {
          sdf_.m_cell_map[0][cell] = static_cast<unsigned>(cell);
          for (int n = 0; n < 32; ++n) {
            const auto& p = places[static_cast<std::size_t>(n)];
            double value = 0;
            for (int c = 0; c < 8; ++c) {
              double w = field.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
              for (std::size_t a = 0; a < 3; ++a) {
                const double t = 0.5 * (p[a] + 1.0);
                w *= (c >> a & 1) != 0 ? t : 1.0 - t;
              }
              value += w;
            }
            sdf_.m_nodes[0][cell * 32 + n] = value;
            sdf_.m_cells[0][cell].m_cells[n] = static_cast<unsigned>(cell * 32 + n);
          }
        }
      }
    }
    sdf_.m_isValid = true;
    bytes_ = static_cast<std::size_t>(count) * (32 * 8 + sizeof(btCell32) + 4);
  }
  [[nodiscard]] std::string name() const override { return "Bullet MiniSDF"; }
  [[nodiscard]] std::string remark() const override { return "cubic shape functions"; }
  [[nodiscard]] std::size_t worldBytes() const override { return bytes_; }
  [[nodiscard]] std::size_t tests() const override { return points_.size(); }

  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    out.count = 0;
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const Eigen::Vector3d u = X_VT * points_[n] / spacing_;
      const btVector3 x(static_cast<btScalar>(u.x()), static_cast<btScalar>(u.y()),
                        static_cast<btScalar>(u.z()));
      double value = 0;
      btVector3 g(0, 0, 0);
      if (!sdf_.interpolate(0, value, x, &g) || value >= 0) continue;
      const double length = g.length();
      const double scale = length > 1e-9 ? 1.0 / length : 0.0;
      out.index[out.count] = static_cast<std::uint32_t>(n);
      out.depth[out.count] = static_cast<float>(-value);
      out.nx[out.count] = static_cast<float>(g.x() * scale);
      out.ny[out.count] = static_cast<float>(g.y() * scale);
      out.nz[out.count] = static_cast<float>(g.z() * scale);
      ++out.count;
    }
  }

 private:
  const std::vector<Eigen::Vector3d>& points_;
  double spacing_;
  btMiniSDF sdf_;
  std::size_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<Peer> makeBullet(const DenseField& field,
                                 const std::vector<Eigen::Vector3d>& points_T) {
  if (field.dims[0] > kMostSide) return nullptr;
  return std::make_unique<BulletPeer>(field, points_T);
}

}  // namespace palpate::bench
#else
namespace palpate::bench {
std::unique_ptr<Peer> makeBullet(const DenseField& /*field*/,
                                 const std::vector<Eigen::Vector3d>& /*points_T*/) {
  return nullptr;
}
}  // namespace palpate::bench
#endif
