#include "ui/arrow_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::ui {
namespace {

constexpr int kSides = 20;
constexpr double kPi = 3.14159265358979323846;

/// A ring of the swept tube: where, which way it runs, how thick, how the surface leans.
struct Ring {
  Eigen::Vector3d centre, along;
  double radius;
  double lean;  ///< Normal's part along `along`.
};

Eigen::Vector3d anyAcross(const Eigen::Vector3d& v) {
  const Eigen::Vector3d other =
      std::abs(v.x()) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return v.cross(other).normalized();
}

void addRing(DrawableMesh& mesh, const Ring& ring, const Eigen::Vector3d& across) {
  const Eigen::Vector3d u = (across - ring.along * across.dot(ring.along)).normalized();
  const Eigen::Vector3d v = ring.along.cross(u);
  for (int i = 0; i < kSides; ++i) {
    const double a = 2.0 * kPi * i / kSides;
    const Eigen::Vector3d out = std::cos(a) * u + std::sin(a) * v;
    const Eigen::Vector3d p = ring.centre + ring.radius * out;
    const Eigen::Vector3d n = (out + ring.lean * ring.along).normalized();
    for (int c = 0; c < 3; ++c) mesh.interleaved.push_back(static_cast<float>(p[c]));
    for (int c = 0; c < 3; ++c) mesh.interleaved.push_back(static_cast<float>(n[c]));
  }
}

DrawableMesh tube(const std::vector<Ring>& rings, const Eigen::Vector3d& across) {
  DrawableMesh mesh;
  for (const Ring& ring : rings) addRing(mesh, ring, across);
  for (std::uint32_t r = 0; r + 1 < rings.size(); ++r) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t j = (i + 1) % kSides;
      const std::uint32_t a = r * kSides;
      const std::uint32_t b = a + kSides;
      for (const std::uint32_t v : {a + i, a + j, b + i, b + i, a + j, b + j}) {
        mesh.triangles.push_back(v);
      }
    }
  }
  return mesh;
}

void addHead(std::vector<Ring>& rings, const Eigen::Vector3d& base, const Eigen::Vector3d& along,
             double length, double radius) {
  rings.push_back({base, along, 0.0, -1e3});
  rings.push_back({base, along, radius, -1e3});
  rings.push_back({base, along, radius, radius / length});
  rings.push_back({base + length * along, along, 0.0, radius / length});
}

}  // namespace

DrawableMesh arrowShape(const Eigen::Vector3d& tail_mm, const Eigen::Vector3d& direction,
                        double length_mm, double radius_mm) {
  const double head = std::min(0.45 * length_mm, 6.5 * radius_mm);
  const Eigen::Vector3d neck = tail_mm + direction * (length_mm - head);
  std::vector<Ring> rings{{tail_mm, direction, 0.0, -1e3},
                          {tail_mm, direction, radius_mm, -1e3},
                          {tail_mm, direction, radius_mm, 0.0},
                          {neck, direction, radius_mm, 0.0}};
  addHead(rings, neck, direction, head, 2.6 * radius_mm);
  return tube(rings, anyAcross(direction));
}

DrawableMesh arcShape(const Eigen::Vector3d& centre_mm, const Eigen::Vector3d& axis,
                      double arcRadius_mm, double angle, double radius_mm) {
  const Eigen::Vector3d u = anyAcross(axis);
  const Eigen::Vector3d v = axis.cross(u);
  const double end = std::clamp(angle, 0.05, 5.5);
  const int steps = std::max(4, static_cast<int>(end * 12.0));
  std::vector<Ring> rings;
  for (int i = 0; i <= steps; ++i) {
    const double a = end * i / steps;
    const Eigen::Vector3d out = std::cos(a) * u + std::sin(a) * v;
    rings.push_back({centre_mm + arcRadius_mm * out, axis.cross(out), radius_mm, 0.0});
  }
  const Ring last = rings.back();
  addHead(rings, last.centre, last.along, 6.5 * radius_mm, 2.6 * radius_mm);
  return tube(rings, axis);
}

}  // namespace palpate::ui
