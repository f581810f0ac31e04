#include "tests/ui/synthetic_case.h"

#include <algorithm>
#include <cmath>

namespace palpate::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Distance-like value of an ellipsoid: below 1 inside.
double ellipsoid(const Eigen::Vector3d& p, const Eigen::Vector3d& centre,
                 const Eigen::Vector3d& radii) {
  return (p - centre).cwiseQuotient(radii).norm();
}

/// HU at a point; head units: x left, y back, z up, skull about 1 in radius.
double hounsfield(const Eigen::Vector3d& p) {
  const double skin = ellipsoid(p, {0, 0, 0.1}, {0.80, 0.98, 0.98});
  const double outer = ellipsoid(p, {0, 0.02, 0.14}, {0.72, 0.90, 0.88});
  const double inner = ellipsoid(p, {0, 0.03, 0.17}, {0.64, 0.81, 0.78});
  const double jaw = ellipsoid(p, {0, -0.42, -0.62}, {0.42, 0.42, 0.34});
  const double jawInside = ellipsoid(p, {0, -0.30, -0.60}, {0.30, 0.38, 0.40});
  const bool eyes =
      ellipsoid({std::abs(p.x()), p.y(), p.z()}, {0.27, -0.80, -0.06}, {0.17, 0.30, 0.15}) < 1.0;
  const bool nose = ellipsoid(p, {0, -0.86, -0.32}, {0.09, 0.26, 0.15}) < 1.0;
  const bool spine = std::hypot(p.x(), p.y() - 0.30) < 0.15 && p.z() < -0.50;
  const bool cord = std::hypot(p.x(), p.y() - 0.36) < 0.06;
  const bool skull = outer < 1.0 && inner >= 1.0 && p.z() > -0.62;
  const bool jawBone = jaw < 1.0 && jawInside >= 1.0 && p.z() < -0.40;
  const bool hole = eyes || nose || cord;
  if ((skull || jawBone || spine) && !hole) {
    return 900.0 + 250.0 * std::sin(9.0 * p.x()) * std::cos(7.0 * p.z());
  }
  if (inner < 1.0) return 35.0 + 12.0 * std::sin(14.0 * p.x()) * std::sin(13.0 * p.y());
  const bool neck = std::hypot(p.x(), p.y() - 0.20) < 0.42 && p.z() < -0.3;
  if (skin < 1.0 || jaw < 1.15 || neck) return -40.0;
  return -1000.0;
}

}  // namespace

Volume syntheticHead(std::int32_t size) {
  Volume head;
  head.modality = "CT";
  head.geometry.dims = {size, size + size / 8, size};
  const double spacing = 0.2 / size;
  head.geometry.spacing = Eigen::Vector3d::Constant(spacing);
  const Eigen::Vector3d middle =
      head.geometry.centre_V(0.5 * (head.geometry.dims[0] - 1), 0.5 * (head.geometry.dims[1] - 1),
                             0.5 * (head.geometry.dims[2] - 1));
  head.geometry.X_PV.translation() = -middle;
  head.int16.reserve(head.geometry.voxelCount());
  for (std::int32_t k = 0; k < head.geometry.dims[2]; ++k) {
    for (std::int32_t j = 0; j < head.geometry.dims[1]; ++j) {
      for (std::int32_t i = 0; i < head.geometry.dims[0]; ++i) {
        const Eigen::Vector3d p = (head.geometry.centre_V(i, j, k) - middle) / 0.098;
        head.int16.push_back(static_cast<std::int16_t>(std::lround(hounsfield(p))));
      }
    }
  }
  return head;
}

LabelGrid syntheticBone(const Volume& head) {
  LabelGrid grid;
  grid.geometry = head.geometry;
  grid.labels.reserve(head.int16.size());
  for (const std::int16_t hu : head.int16) grid.labels.push_back(hu >= 300 ? 1 : 0);
  return grid;
}

Instrument syntheticBurr() {
  // Profile: distance from the tip along the shaft, radius; mm.
  std::vector<std::array<double, 2>> profile;
  for (int i = 1; i < 12; ++i) {
    const double a = kPi * i / 13.0;
    profile.push_back({3.0 - 3.0 * std::cos(a), 3.0 * std::sin(a)});
  }
  for (const auto& p :
       {std::array{7.0, 1.1}, {45.0, 1.1}, {48.0, 4.0}, {60.0, 5.5}, {120.0, 6.0}, {122.0, 5.0}}) {
    profile.push_back(p);
  }
  Instrument burr;
  burr.name = "ball-burr";
  burr.title = "Ball burr, 6 mm";
  constexpr int kSides = 32;
  burr.mesh_T.vertices.emplace_back(0, 0, 0);
  for (const auto& [z, r] : profile) {
    for (int s = 0; s < kSides; ++s) {
      const double a = 2.0 * kPi * s / kSides;
      burr.mesh_T.vertices.emplace_back(1e-3 * r * std::cos(a), 1e-3 * r * std::sin(a), 1e-3 * z);
    }
  }
  burr.mesh_T.vertices.emplace_back(0, 0, 0.122);
  const auto ring = [](std::size_t r, int s) {
    return static_cast<std::uint32_t>(1 + r * kSides +
                                      static_cast<std::size_t>((s + kSides) % kSides));
  };
  const std::size_t rings = profile.size();
  const auto last = static_cast<std::uint32_t>(burr.mesh_T.vertices.size() - 1);
  for (int s = 0; s < kSides; ++s) {
    burr.mesh_T.triangles.push_back({0, ring(0, s + 1), ring(0, s)});
    for (std::size_t r = 0; r + 1 < rings; ++r) {
      burr.mesh_T.triangles.push_back({ring(r, s), ring(r, s + 1), ring(r + 1, s)});
      burr.mesh_T.triangles.push_back({ring(r + 1, s), ring(r, s + 1), ring(r + 1, s + 1)});
    }
    burr.mesh_T.triangles.push_back({last, ring(rings - 1, s), ring(rings - 1, s + 1)});
  }
  return burr;
}

Snapshot syntheticContact(const Volume&) {
  Snapshot s;
  s.step = 1234;
  s.t = 1.234;
  const Eigen::Vector3d outward = Eigen::Vector3d(0.30, -0.72, 0.62).normalized();
  const Eigen::Vector3d surface(0.024, -0.0640, 0.0600);
  Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), outward);
  s.tool = plain(surface - 0.0004 * outward, q);
  s.device = plain(surface - 0.0034 * outward, q);
  for (int c = 0; c < 3; ++c) s.felt.force[c] = 1.24 * outward[c];
  s.contact.torque[0] = 0.012;
  s.contact.torque[1] = 0.006;
  for (int ring = 0; ring < 9; ++ring) {
    const int count = ring == 0 ? 1 : 6 * ring;
    for (int i = 0; i < count; ++i) {
      const double a = 2.0 * kPi * i / count;
      const double r = 0.00025 * ring;
      const Eigen::Vector3d local(r * std::cos(a), r * std::sin(a), r * r / 0.006);
      const Eigen::Vector3d p = surface - 0.0004 * outward + q * local;
      Contact& contact = s.contact_W[s.contactsDrawn];
      for (int c = 0; c < 3; ++c) contact.p[c] = p[c];
      for (int c = 0; c < 3; ++c) contact.n[c] = outward[c];
      contact.depth = std::max(0.0, 0.0009 * (1.0 - ring / 9.0));
      contact.label = 1;
      ++s.contactsDrawn;
    }
  }
  s.contacts = s.contactsDrawn;
  s.depth = 0.00018;
  s.safety = SafetyState::Armed;
  s.stepTime = {84, 131, 160, 210};
  s.tickTime = {9, 14, 22, 40};
  return s;
}

}  // namespace palpate::test
