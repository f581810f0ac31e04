#include "tests/benchmarks/probe.h"

#include <cmath>

namespace palpate::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;

// A body of revolution about z between two heights, radius by height.
struct Part {
  double z0, z1, r;
  bool sphere;
  [[nodiscard]] double area() const { return 2 * kPi * r * (z1 - z0); }  // both, by Archimedes
};

}  // namespace

std::vector<Eigen::Vector3d> drillPoints(std::size_t points) {
  const double neck = std::sqrt(kBurrRadius * kBurrRadius - 2e-3 * 2e-3);
  const Part parts[] = {{-kBurrRadius, neck, kBurrRadius, true},
                        {neck, 30e-3, 2e-3, false},
                        {30e-3, 75e-3, 6e-3, false}};
  double area = 0;
  for (const Part& part : parts) area += part.area();
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  std::vector<Eigen::Vector3d> out;
  out.reserve(points);
  for (const Part& part : parts) {
    const auto count =
        static_cast<std::size_t>(std::round(static_cast<double>(points) * part.area() / area));
    for (std::size_t i = 0; i < count; ++i) {
      const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
      const double z = part.z0 + t * (part.z1 - part.z0);
      const double r = part.sphere ? std::sqrt(part.r * part.r - z * z) : part.r;
      const double phi = golden * static_cast<double>(i);
      out.emplace_back(r * std::cos(phi), r * std::sin(phi), z);
    }
  }
  return out;
}

}  // namespace palpate::bench
