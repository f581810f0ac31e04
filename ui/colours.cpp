#include "ui/colours.h"

#include <algorithm>

namespace palpate::ui {

Rgb contactColour(double depth_m) {
  constexpr Rgb kPale{1.0F, 0.953F, 0.659F};
  constexpr Rgb kDeep{0.851F, 0.373F, 0.055F};
  const auto f = static_cast<float>(std::clamp(depth_m / kDeepestColour_m, 0.0, 1.0));
  Rgb c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = kPale[i] + f * (kDeep[i] - kPale[i]);
  return c;
}

}  // namespace palpate::ui
