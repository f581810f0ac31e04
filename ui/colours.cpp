#include "ui/colours.h"

#include <algorithm>

namespace palpate::ui {

std::array<std::uint8_t, 3> labelColour(std::size_t index) {
  constexpr std::array<std::array<std::uint8_t, 3>, 7> kOkabeIto{{{230, 159, 0},
                                                                  {86, 180, 233},
                                                                  {0, 158, 115},
                                                                  {240, 228, 66},
                                                                  {0, 114, 178},
                                                                  {213, 94, 0},
                                                                  {204, 121, 167}}};
  return kOkabeIto[index % kOkabeIto.size()];
}

Rgb contactColour(double depth_m) {
  constexpr Rgb kPale{1.0F, 0.953F, 0.659F};
  constexpr Rgb kDeep{0.851F, 0.373F, 0.055F};
  const auto f = static_cast<float>(std::clamp(depth_m / kDeepestColour_m, 0.0, 1.0));
  Rgb c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = kPale[i] + f * (kDeep[i] - kPale[i]);
  return c;
}

}  // namespace palpate::ui
