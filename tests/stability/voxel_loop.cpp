#include "tests/stability/voxel_loop.h"

#include "tests/core/simulation/synthetic_scene.h"

namespace palpate::stability {
namespace {

/// Keeps all; room is taken beforehand.
class KeepAll final : public RunSink {
 public:
  KeepAll(VoxelResult& out, std::size_t capacity) : out_(out) {
    out_.samples.reserve(capacity);
    out_.steps.reserve(capacity);
  }
  bool onTick(const ServoSample& sample) noexcept override {
    out_.samples.push_back(sample);
    return true;
  }
  bool onStep(const StepRecord& step) noexcept override {
    out_.steps.push_back(step);
    return true;
  }
  bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }

 private:
  VoxelResult& out_;
};

constexpr std::int32_t kAir = 4;  // voxels above the face: where the anatomy's distances begin

std::shared_ptr<LabelGrid> gridOf(const VoxelCase& c) {
  auto grid = std::make_shared<LabelGrid>();
  grid->geometry.dims = c.dims;
  grid->geometry.spacing.setConstant(c.voxel);
  // Oblique and away from the origin: a mistake in a frame must show.
  grid->geometry.X_PV = Eigen::Translation3d(0.03, -0.02, 0.07) *
                        Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, -2, 0.5).normalized());
  grid->labels.assign(grid->geometry.voxelCount(), 0);
  std::size_t at = 0;
  for (std::int32_t k = 0; k < c.dims[2]; ++k) {
    for (std::int32_t j = 0; j < c.dims[1]; ++j) {
      for (std::int32_t i = 0; i < c.dims[0]; ++i, ++at) {
        const double x = c.voxel * (i + 0.5 - 0.5 * c.dims[0]);
        const double y = c.voxel * (j + 0.5 - (c.dims[1] - kAir));
        const double z = c.voxel * (k + 0.5 - 0.5 * c.dims[2]);
        grid->labels[at] = c.solid(x, y, z) ? 1 : 0;
      }
    }
  }
  return grid;
}

}  // namespace

VoxelResult runOnVoxels(const VoxelCase& c) {
  const auto grid = gridOf(c);
  Scene scene;
  // D at the middle of the top face of the last layer.
  scene.X_WD =
      grid->geometry.X_PV *
      Eigen::Translation3d(c.voxel * Eigen::Vector3d(0.5 * (c.dims[0] - 1), c.dims[1] - kAir - 0.5,
                                                     0.5 * (c.dims[2] - 1)));
  const auto prepared = prepareScene(scene, grid, boneTable(), datasetMaterials(),
                                     c.instrument ? *c.instrument : datasetInstrument());
  EXPECT_TRUE(prepared) << sentence(prepared.error());
  auto device = makeSimulatedPhantom("touch-x", c.hand, c.seed);
  EXPECT_TRUE(device);
  VoxelResult out;
  out.limits = recommendedLimits((*device)->info());
  KeepAll sink(out, static_cast<std::size_t>(1000.0 * c.seconds) + 10);
  RunOptions options;
  options.seed = c.seed;
  options.sink = &sink;
  auto runner = Runner::create(*prepared, std::move(*device), options);
  EXPECT_TRUE(runner) << sentence(runner.error());
  EXPECT_TRUE((*runner)->runVirtual(c.seconds, {}));
  out.report = (*runner)->report();
  for (const StepRecord& step : out.steps) {
    out.tip_D.push_back(scene.X_WD->inverse() * position(step.tool));
  }
  return out;
}

}  // namespace palpate::stability
