#include "tests/benchmarks/trajectory.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/benchmarks/probe.h"
#include "tests/benchmarks/world.h"

namespace palpate::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The tool's lowest point touches the upper face at (x, y) of the box's frame, sunk in by `press`;
// the shaft leans by `tilt` from the face's normal towards `heading`, turned about itself by
// `roll`.
Eigen::Isometry3d onFace(double x, double y, double press, double tilt, double heading,
                         double roll) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = (Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  X.translation() = Eigen::Vector3d(x, y, kBoneTop + kBurrRadius - press);
  return boneFrame() * X;
}

Eigen::Isometry3d sliding(double t, double press) {
  return onFace(18e-3 * std::sin(2 * kPi * t), 16e-3 * std::sin(6 * kPi * t + 0.4), press,
                0.45 + 0.15 * std::sin(10 * kPi * t), 2 * kPi * t, 5 * t);
}

// Nearly flat: burr and handle both go in.
Eigen::Isometry3d pressed(double x, double press, double heading) {
  return onFace(x, 3e-3, press, 1.53, heading, 0.7);
}

// One approach of random50 at fraction t of its way.
Eigen::Isometry3d fromAnywhere(std::mt19937_64 random, double t, double press) {
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  const Eigen::Vector3d out = direction();
  const Eigen::Vector3d lean = 0.5 * direction();
  double reach = 0.0;  // to the surface along `out`
  const Eigen::Vector3d centre = boneFrame().translation();
  for (int i = 0; i < 60; ++i) reach -= boneSurface(centre + reach * out);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), (out + lean).normalized())
          .toRotationMatrix();
  X.translation() = centre + (reach + kBurrRadius + 8e-3 - t * (8e-3 + press)) * out;
  return X;
}

}  // namespace

Trajectory makeTrajectory(const std::string& name, double press, std::size_t steps,
                          std::uint64_t seed) {
  Trajectory result{name, {}};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (std::size_t i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(steps);
    if (name == "slide") {
      result.X_VT.push_back(sliding(t, press));
    } else if (name == "approach") {
      result.X_VT.push_back(pressed(-38e-3, t * (10e-3 + press) - 10e-3, 0.1));
    } else if (name == "flat") {
      result.X_VT.push_back(pressed(-38e-3 + 6e-3 * t, press * (0.6 + 0.4 * std::sin(9 * t)), 0.1));
    } else if (name == "random50") {
      const double way = 50.0 * t;
      const auto which = static_cast<std::uint64_t>(way);
      result.X_VT.push_back(
          fromAnywhere(std::mt19937_64(seed + 1 + which), way - std::floor(way), press));
    } else if (name == "teleport") {
      const double kind = unit(random);
      const double at = unit(random);
      if (kind < 0.2) {
        result.X_VT.push_back(onFace(0, 0, -0.02 - 0.1 * at, 1.0, 6 * at, 0));
      } else if (kind < 0.6) {
        result.X_VT.push_back(sliding(at, press));
      } else {
        result.X_VT.push_back(pressed(-38e-3, press * at, 6.28 * unit(random)));
      }
    } else if (name == "away") {
      result.X_VT.push_back(onFace(10e-3 * std::sin(6 * t), 0, -0.03, 0.3, 6 * t, 0));
    }
  }
  return result;
}

Trajectory slideAround(const DenseField& field, double press, std::size_t steps) {
  Trajectory result{"slide", {}};
  const Eigen::Vector3d box = Eigen::Vector3d(field.spacing[0] * (field.dims[0] - 1),
                                              field.spacing[1] * (field.dims[1] - 1),
                                              field.spacing[2] * (field.dims[2] - 1));
  const auto distance = [&](const Eigen::Vector3d& p) {  // to the surface, from the nearest sample
    std::int32_t at[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      at[a] = std::clamp(static_cast<std::int32_t>(std::lround(p[i] / field.spacing[a])), 0,
                         field.dims[a] - 1);
    }
    return field.at(at[0], at[1], at[2]) * field.unit;
  };
  for (std::size_t i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(steps);
    const double phi = 2 * kPi * t;
    const double theta = kPi / 2 + 0.5 * std::sin(3 * phi);
    const Eigen::Vector3d out(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                              std::cos(theta));
    double reach = 0.5 * box.norm();
    for (int k = 0; k < 400 && reach > 0; ++k) {
      const double gap = distance(0.5 * box + reach * out) - (kBurrRadius - press);
      if (gap < 0.25 * field.unit) break;
      reach -= std::max(0.5 * gap, 0.1 * field.unit);
    }
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = (Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out) *
                  Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
    X.translation() = 0.5 * box + reach * out;
    result.X_VT.push_back(X);
  }
  return result;
}

double usualPress(const std::string& name, std::size_t points) {
  if (name == "approach") return 1.9e-3;
  if (name == "flat" || name == "teleport") return 2.4e-3;
  if (name == "random50") return 4e-3;
  return points <= 2000 ? 7e-3 : points <= 30000 ? 2.2e-3 : 0.75e-3;
}

}  // namespace palpate::bench
