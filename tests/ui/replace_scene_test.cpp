/// An anatomy that is edited while it is felt: the run goes on in the new one. No display.

#include <gtest/gtest.h>

#include "app/desktop_simulation.h"
#include "app/scene_loading.h"
#include "core/scene/material.h"

namespace palpate {
namespace {

/// A block whose upper face is `top` slices of a millimetre above the first.
std::shared_ptr<const LabelGrid> block(int top) {
  auto grid = std::make_shared<LabelGrid>();
  grid->geometry.dims = {64, 64, 64};
  grid->labels.assign(grid->geometry.voxelCount(), 0);
  for (int k = 2; k < top; ++k) {
    for (int j = 2; j < 62; ++j) {
      for (int i = 2; i < 62; ++i) grid->labels[grid->geometry.index(i, j, k)] = 1;
    }
  }
  return grid;
}

std::shared_ptr<const PreparedScene> sceneOf(int top) {
  const std::filesystem::path datasets = PALPATE_DATASETS;
  const auto materials = readMaterials(datasets / "materials.toml");
  const auto instruments = readInstruments(datasets / "instruments");
  EXPECT_TRUE(materials && instruments);
  auto prepared = prepareScene(defaultScene(), block(top), {LabelInfo{.name = "bone"}}, *materials,
                               instruments->front(), {}, {});
  EXPECT_TRUE(prepared) << (prepared ? "" : sentence(prepared.error()));
  return prepared ? *prepared : nullptr;
}

TEST(ReplaceScene, TheRunGoesOnWithTheHandWhereItWasAndNoForce) {
  DesktopSimulation simulation;
  const auto before = sceneOf(40), after = sceneOf(30);
  ASSERT_TRUE(before && after);
  simulation.setScene(before);
  ASSERT_TRUE(simulation.start(Clock::Virtual, {}));
  simulation.advanceVirtual(0.2);
  const Eigen::Vector3d atRest = position(simulation.refresh()->device);
  simulation.moveHand({0.004, -0.003, 0.002});
  simulation.advanceVirtual(3.0);  // until the arm rests
  const Snapshot was = *simulation.refresh();
  ASSERT_TRUE(simulation.replaceScene(after));
  EXPECT_TRUE(simulation.running());
  EXPECT_EQ(simulation.scene(), after.get());
  simulation.advanceVirtual(3.0);
  const Snapshot is = *simulation.refresh();
  // The simulated arm sticks a little short of the hand, by where it comes from.
  EXPECT_LT((position(is.device) - position(was.device)).norm(), 1.5e-3);
  EXPECT_GT((position(was.device) - atRest).norm(), 4e-3);
  for (const double newtons : is.felt.force) EXPECT_EQ(newtons, 0.0);
}

TEST(ReplaceScene, WhatDoesNotRunStaysStopped) {
  DesktopSimulation simulation;
  ASSERT_TRUE(simulation.replaceScene(sceneOf(40)));
  EXPECT_FALSE(simulation.running());
  ASSERT_TRUE(simulation.replaceScene(nullptr));
  EXPECT_EQ(simulation.scene(), nullptr);
}

}  // namespace
}  // namespace palpate
