#include "core/scene/instrument_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

bool isPoint(const CrossSection& section) {
  return section.halfAxes.x() == 0.0 && section.halfAxes.y() == 0.0;
}

Error badSection(std::size_t index, std::string message, std::string expected) {
  return inputRefused(std::move(message))
      .inField("section[" + std::to_string(index) + "]")
      .wants(std::move(expected));
}

Result<void> checkSections(const std::vector<CrossSection>& sections) {
  if (sections.size() < 2) {
    return fail(badSection(sections.size(), "An instrument needs at least two sections.",
                           "two sections or more"));
  }
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const bool end = i == 0 || i + 1 == sections.size();
    const bool positive = sections[i].halfAxes.minCoeff() > 0.0;
    if (!positive && !(end && isPoint(sections[i]))) {
      return fail(badSection(i, "A section has a half-axis that is not positive.",
                             "positive half-axes, or both zero at an end"));
    }
    if (i > 0 && (sections[i].p_T - sections[i - 1].p_T).norm() < 1e-7) {
      return fail(badSection(i, "Two sections lie in one place.",
                             "at least 0.0001 mm from the section before"));
    }
  }
  return {};
}

/// Directions of the path at each section: across a bend, the mean of the two legs.
Result<std::vector<Eigen::Vector3d>> tangentsOf(const std::vector<CrossSection>& sections) {
  std::vector<Eigen::Vector3d> legs;
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    legs.push_back((sections[i + 1].p_T - sections[i].p_T).normalized());
  }
  std::vector<Eigen::Vector3d> tangents{legs.front()};
  for (std::size_t i = 1; i < legs.size(); ++i) {
    // Past a right angle neighbouring rings would cut through each other.
    if (legs[i - 1].dot(legs[i]) <= 0.0) {
      return fail(
          badSection(i, "The path folds back on itself.", "a bend of less than 90 degrees"));
    }
    tangents.push_back((legs[i - 1] + legs[i]).normalized());
  }
  tangents.push_back(legs.back());
  return tangents;
}

/// x axis of the first section: T's x, made square to the path (or T's y, where the path is along
/// x).
Eigen::Vector3d firstAxis(const Eigen::Vector3d& tangent) {
  Eigen::Vector3d start = Eigen::Vector3d::UnitX();
  if (std::abs(tangent.x()) > 0.9) start = Eigen::Vector3d::UnitY();
  return (start - start.dot(tangent) * tangent).normalized();
}

/// First vertex of a section, and how many it has: one for a point.
struct Ring {
  std::uint32_t first = 0, count = 1;
  [[nodiscard]] std::uint32_t at(std::uint32_t k) const { return first + k % count; }
};

class Sweep {
 public:
  explicit Sweep(std::uint32_t around) : around_(around) {}

  Ring addRing(const CrossSection& section, const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
    Ring ring{static_cast<std::uint32_t>(mesh.vertices.size()), 1};
    if (isPoint(section)) {
      mesh.vertices.push_back(section.p_T);
      return ring;
    }
    ring.count = around_;
    for (std::uint32_t k = 0; k < around_; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around_;
      const double a = section.halfAxes.x() * std::cos(angle);
      const double b = section.halfAxes.y() * std::sin(angle);
      const double u = a * std::cos(section.twist) - b * std::sin(section.twist);
      const double v = a * std::sin(section.twist) + b * std::cos(section.twist);
      mesh.vertices.emplace_back(section.p_T + u * x + v * y);
    }
    return ring;
  }

  void join(const Ring& low, const Ring& high) {
    for (std::uint32_t k = 0; k < around_; ++k) {
      if (low.count > 1) mesh.triangles.push_back({low.at(k), low.at(k + 1), high.at(k)});
      if (high.count > 1) mesh.triangles.push_back({high.at(k), low.at(k + 1), high.at(k + 1)});
    }
  }

  /// Closes an end flat, facing along the path (`last`) or against it.
  void close(const Ring& ring, const Eigen::Vector3d& centre, bool last) {
    if (ring.count == 1) return;
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(centre);
    for (std::uint32_t k = 0; k < ring.count; ++k) {
      const auto a = ring.at(k);
      const auto b = ring.at(k + 1);
      mesh.triangles.push_back(last ? std::array{middle, a, b} : std::array{middle, b, a});
    }
  }

  TriangleMesh mesh;

 private:
  std::uint32_t around_;
};

}  // namespace

Result<TriangleMesh> sweepSections(const std::vector<CrossSection>& sections,
                                   std::uint32_t around) {
  if (auto checked = checkSections(sections); !checked) return fail(checked.error());
  const auto tangents = tangentsOf(sections);
  if (!tangents) return fail(tangents.error());
  Sweep sweep(around);
  Eigen::Vector3d x = firstAxis(tangents->front());
  std::vector<Ring> rings;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Eigen::Vector3d& t = (*tangents)[i];
    if (i > 0) x = Eigen::Quaterniond::FromTwoVectors((*tangents)[i - 1], t) * x;
    x = (x - x.dot(t) * t).normalized();
    rings.push_back(sweep.addRing(sections[i], x, t.cross(x)));
    if (i > 0) sweep.join(rings[i - 1], rings[i]);
  }
  sweep.close(rings.front(), sections.front().p_T, false);
  sweep.close(rings.back(), sections.back().p_T, true);
  if (!isClosed(sweep.mesh) || !(signedVolume(sweep.mesh) > 0.0)) {
    return fail(badSection(sections.size() - 1, "The sections enclose no volume.",
                           "sections that sweep out a body"));
  }
  return std::move(sweep.mesh);
}

}  // namespace palpate
