#include "ui/orientation.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::ui {

std::string orientationLetters(const Eigen::Vector3d& direction_P) {
  const double length = direction_P.norm();
  if (!(length > 0.0)) return {};
  constexpr double kLeast = 0.258819;  // sin(15°): below it the letter misleads more than it says
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&direction_P](int a, int b) {
    return std::abs(direction_P[a]) > std::abs(direction_P[b]);
  });
  std::string letters;
  for (const int axis : order) {
    const double part = direction_P[axis] / length;
    if (std::abs(part) < kLeast) continue;
    letters += "LPHRAF"[part > 0.0 ? axis : axis + 3];
  }
  return letters;
}

}  // namespace palpate::ui
