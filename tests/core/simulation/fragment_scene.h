#pragma once
/// Loose cubes of bone above a basin of bone, for tests.

#include <array>
#include <memory>
#include <vector>

#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {

inline constexpr std::uint8_t kBone = 1, kFragment = 2;

inline LabelTable tableOfTwo() {
  return {{"bone", kBone, {227, 211, 177}, "bone"}, {"fragment", kFragment, {0, 114, 178}, "bone"}};
}

/// A slab of bone, z below 0 mm in its own axes, with a basin of 20 mm radius; cubes of `side`
/// voxels above it, at these places (voxels from the grid's middle).
inline std::shared_ptr<LabelGrid> basin(const std::vector<std::array<int, 3>>& cubes, int side) {
  auto grid = syntheticGrid([](double x, double y, double z) {
    const bool bowl = x * x + y * y + (z - 10.0) * (z - 10.0) < 20.0 * 20.0;
    return z < 0.0 && !bowl && x > -30 && x < 30 && y > -30 && y < 30 && z > -28;
  });
  for (const auto& at : cubes) {
    for (int k = 0; k < side; ++k) {
      for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
          const int m = 32;
          grid->labels[grid->geometry.index(m + at[0] + i, m + at[1] + j, m + at[2] + k)] =
              kFragment;
        }
      }
    }
  }
  return grid;
}

inline Scene sceneWithFragments(const Eigen::Vector3d& gravity) {
  Scene scene;
  scene.bodies = {{"fragment", true, 1.0}};
  scene.surroundings.gravity = gravity;
  scene.surroundings.drag = 1.0;
  return scene;
}

inline Result<std::shared_ptr<const PreparedScene>> prepare(const Scene& scene,
                                                            std::shared_ptr<const LabelGrid> grid) {
  return prepareScene(scene, std::move(grid), tableOfTwo(), datasetMaterials(),
                      datasetInstrument());
}

/// The instrument held still far from everything.
inline DeviceSample farAway(const PreparedScene& scene, std::uint64_t index) {
  DeviceSample sample;
  sample.index = index;
  sample.pose = plain(scene.X_WD * Eigen::Translation3d(0, 0.5, 0));
  return sample;
}

}  // namespace palpate
