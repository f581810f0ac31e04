#include "ui/view_state.h"

#include <algorithm>

#include "core/geometry/units.h"
#include "ui/slice_geometry.h"

namespace palpate::ui {

std::array<double, 2> startingWindow(const Volume& volume) {
  if (volume.modality == "CT") {
    // Unless all of it would be black or white: then the scanner's values are not Hounsfield units.
    const auto [least, most] = valueRange(volume);
    if (most > -600.0 && least < 1400.0) return {400.0, 2000.0};
  }
  std::vector<double> sample;
  const std::size_t stride = std::max<std::size_t>(1, volume.size() / 65536);
  for (std::size_t i = 0; i < volume.size(); i += stride) sample.push_back(volume.value(i));
  if (sample.empty()) return {0.5, 1.0};
  const auto at = [&sample](double share) {
    const auto n = static_cast<std::ptrdiff_t>(share * static_cast<double>(sample.size() - 1));
    std::nth_element(sample.begin(), sample.begin() + n, sample.end());
    return sample[static_cast<std::size_t>(n)];
  };
  const double low = at(0.01);
  const double high = at(0.99);
  return {0.5 * (low + high), std::max(1e-6, high - low)};
}

void resetViews(ViewState& state, const GridGeometry& grid, const std::array<double, 2>& window,
                double sceneAspect) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e30);
  Eigen::Vector3d high = -low;
  for (const auto& corner : grid.cornerCentres_P()) {
    low = low.cwiseMin(corner * kMillimetresPerMetre);
    high = high.cwiseMax(corner * kMillimetresPerMetre);
  }
  state.camera.frame(low, high, sceneAspect);
  const Eigen::Vector3d middle(0.5 * (grid.dims[0] - 1), 0.5 * (grid.dims[1] - 1),
                               0.5 * (grid.dims[2] - 1));
  state.crosshair_P = pointOf(grid, middle);
  state.window = window;
  state.slice = {};
  state.preview.reset();
}

}  // namespace palpate::ui
