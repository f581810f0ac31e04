#pragma once
/// Anatomy of known shape, for tests: made in memory, the same on every machine.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/devices/simulated_phantom.h"
#include "core/simulation/prepared_scene.h"
#include "core/simulation/runner.h"

#ifdef __SANITIZE_THREAD__
#include <tbb/global_control.h>
#endif

namespace palpate {

#ifdef __SANITIZE_THREAD__
// Debian's TBB is not instrumented: what its workers hand over looks like races. Trees are built on
// one thread here; the loops' own threads, which these tests are about, are all watched.
inline const tbb::global_control kOneBuilder(tbb::global_control::max_allowed_parallelism, 1);
#endif

/// 64 mm cube of 1 mm voxels (or `mm`), its first voxel at a corner of P away from the origin.
/// `solid` is asked with the voxel's place in mm from the middle of the grid.
inline std::shared_ptr<LabelGrid> syntheticGrid(
    const std::function<bool(double x, double y, double z)>& solid, int voxels = 64,
    double mm = 1.0) {
  auto grid = std::make_shared<LabelGrid>();
  grid->geometry.dims = {voxels, voxels, voxels};
  grid->geometry.spacing = Eigen::Vector3d::Constant(1e-3 * mm);
  grid->geometry.X_PV.translation() = Eigen::Vector3d(-0.12, -0.05, 0.31);
  grid->labels.resize(grid->geometry.voxelCount());
  const double middle = 0.5 * (voxels - 1);
  for (int k = 0; k < voxels; ++k) {
    for (int j = 0; j < voxels; ++j) {
      for (int i = 0; i < voxels; ++i) {
        const bool in = solid(mm * (i - middle), mm * (j - middle), mm * (k - middle));
        grid->labels[grid->geometry.index(i, j, k)] = in ? 1 : 0;
      }
    }
  }
  return grid;
}

inline std::shared_ptr<LabelGrid> ball(double radius_mm = 24.0) {
  return syntheticGrid([radius_mm](double x, double y, double z) {
    return x * x + y * y + z * z < radius_mm * radius_mm;
  });
}

inline Instrument datasetInstrument(const std::string& name = "ball-burr") {
  const auto folder = std::filesystem::path(PALPATE_DATASETS) / "instruments";
  auto instrument = readInstrument(folder / (name + ".toml"));
  EXPECT_TRUE(instrument) << sentence(instrument.error());
  return *instrument;
}

inline std::vector<Material> datasetMaterials() {
  auto materials = readMaterials(std::filesystem::path(PALPATE_DATASETS) / "materials.toml");
  EXPECT_TRUE(materials) << sentence(materials.error());
  return *materials;
}

inline LabelTable boneTable() {
  return {{"bone", 1, {227, 211, 177}, "bone"}};
}

inline std::shared_ptr<const PreparedScene> prepared(std::shared_ptr<const LabelGrid> grid,
                                                     const Scene& scene = {},
                                                     const std::string& instrument = "ball-burr") {
  auto made = prepareScene(scene, std::move(grid), boneTable(), datasetMaterials(),
                           datasetInstrument(instrument));
  EXPECT_TRUE(made) << sentence(made.error());
  return made ? *made : nullptr;
}

inline std::unique_ptr<HapticDevice> searchingDevice(std::uint64_t seed,
                                                     const std::string& model = "touch-x") {
  auto device = makeSimulatedPhantom(model, makeSearchingHand(seed), seed);
  EXPECT_TRUE(device) << sentence(device.error());
  return std::move(*device);
}

inline std::unique_ptr<Runner> makeRunner(std::shared_ptr<const PreparedScene> scene,
                                          const RunOptions& options,
                                          const std::string& model = "touch-x") {
  auto runner = Runner::create(std::move(scene), searchingDevice(options.seed, model), options);
  EXPECT_TRUE(runner) << sentence(runner.error());
  return std::move(*runner);
}

}  // namespace palpate
