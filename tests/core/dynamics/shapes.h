#pragma once
/// Closed meshes and contacts with known answers.

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/collision/contact.h"
#include "core/geometry/triangle_mesh.h"

namespace palpate::test {

inline TriangleMesh box(const Eigen::Vector3d& size, const Eigen::Vector3d& centre) {
  TriangleMesh m;
  for (int i = 0; i < 8; ++i) {
    m.vertices.push_back(centre + Eigen::Vector3d((i & 1) != 0 ? 0.5 : -0.5,
                                                  (i & 2) != 0 ? 0.5 : -0.5,
                                                  (i & 4) != 0 ? 0.5 : -0.5)
                                      .cwiseProduct(size));
  }
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// An icosahedron, each triangle split in four `times` times, corners on the sphere.
inline TriangleMesh sphere(double radius, int times, const Eigen::Vector3d& centre) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh m;
  m.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  m.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int t = 0; t < times; ++t) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto between = [&](std::uint32_t a, std::uint32_t b) {
      const auto key = std::minmax(a, b);
      const auto [it, isNew] = middle.try_emplace({key.first, key.second},
                                                  static_cast<std::uint32_t>(m.vertices.size()));
      if (isNew) {
        m.vertices.push_back((m.vertices[a].normalized() + m.vertices[b].normalized()));
      }
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& f : m.triangles) {
      const auto a = between(f[0], f[1]), b = between(f[1], f[2]), c = between(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
    }
    m.triangles = finer;
  }
  for (auto& v : m.vertices) v = centre + radius * v.normalized();
  return m;
}

/// A prism of `sides` along z, corners on the radius.
inline TriangleMesh prism(double radius, double height, int sides, const Eigen::Vector3d& centre) {
  TriangleMesh m;
  for (int i = 0; i < sides; ++i) {
    const double a = 2.0 * M_PI * i / sides;
    for (const double z : {-0.5 * height, 0.5 * height}) {
      m.vertices.push_back(centre + Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), z));
    }
  }
  const auto bottom = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.push_back(centre - Eigen::Vector3d(0, 0, 0.5 * height));
  m.vertices.push_back(centre + Eigen::Vector3d(0, 0, 0.5 * height));
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    m.triangles.insert(
        m.triangles.end(),
        {{a, b, b + 1}, {a, b + 1, a + 1}, {bottom, b, a}, {bottom + 1, a + 1, b + 1}});
  }
  return m;
}

inline Contact contactAt(const Eigen::Vector3d& p, const Eigen::Vector3d& n, double depth,
                         std::uint8_t label = 1) {
  Contact c;
  for (int i = 0; i < 3; ++i) {
    c.p[i] = p[i];
    c.n[i] = n[i];
  }
  c.depth = depth;
  c.label = label;
  return c;
}

inline Eigen::Vector3d randomVector(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> d(-size, size);
  const double x = d(random), y = d(random), z = d(random);
  return {x, y, z};
}

}  // namespace palpate::test
