/// Levels of a scene: what they mean, and how they are changed.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/simulation/contact_gathering.h"
#include "core/simulation/simulation.h"
#include "tests/core/simulation/fragment_scene.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

std::vector<GovernorLevel> someLevels(const SimulationSetting& own) {
  std::vector<GovernorLevel> levels(5);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].name = "level " + std::to_string(i);
    levels[i].perceptualBound = own.query.perceptualBound;
    levels[i].contactBudget = own.query.contactBudget;
    levels[i].solverIterations = own.solverIterations;
    levels[i].stepP99_us = 50.0 / static_cast<double>(i + 1);
  }
  levels[1].solverIterations = 3;
  levels[2].perceptualBound = 1.5e-3;
  levels[3].contactBudget = 2;
  levels[4].stopLevel = 1;
  return levels;
}

std::shared_ptr<const PreparedScene> leveled(const PreparedScene& scene) {
  auto made = withLevels(scene, someLevels(scene.scene.setting));
  EXPECT_TRUE(made) << sentence(made.error());
  return made ? *made : nullptr;
}

/// Pressed 3 mm in and slid.
DeviceSample pressed(const PreparedScene& scene, std::uint64_t index) {
  DeviceSample sample;
  sample.index = index;
  sample.t = 1e-3 * static_cast<double>(index);
  sample.pose = plain(scene.X_WD);
  const double along = 2e-3 * std::sin(0.01 * static_cast<double>(index));
  const Eigen::Vector3d shift = scene.X_WD.linear() * Eigen::Vector3d(along, -3e-3, 0.5 * along);
  for (int axis = 0; axis < 3; ++axis) sample.pose.p[axis] += shift[axis];
  return sample;
}

TEST(Level, ASimulationAtALevelMakesTheBitsOfASceneWithThatSetting) {
  const auto scene = leveled(*prepared(ball()));
  std::vector<std::uint64_t> hashes;
  for (std::size_t level = 0; level < scene->levels.size(); ++level) {
    Scene same;
    same.setting = settingAt(scene->scene.setting, scene->levels[level]);
    Simulation changed(scene, CouplingGains{}), prepared_(prepared(ball(), same), CouplingGains{});
    changed.apply({Command::Kind::SetLevel, static_cast<double>(level)});
    prepared_.apply({Command::Kind::SetLevel, 0});  // counted in the hash, else nothing there
    std::uint32_t contacts = 0;
    for (std::uint64_t i = 0; i < 600; ++i) {
      contacts = std::max(contacts, changed.step(pressed(*scene, i)).contacts);
      (void)prepared_.step(pressed(*scene, i));
    }
    EXPECT_EQ(changed.level(), level);
    EXPECT_EQ(changed.record().level, level);
    EXPECT_EQ(changed.record().stateHash, prepared_.record().stateHash) << level;
    EXPECT_GT(contacts, 0u);
    hashes.push_back(changed.record().stateHash);
  }
  for (std::size_t level = 1; level < hashes.size(); ++level) {
    EXPECT_NE(hashes[level], hashes[0]) << "level " << level << " changes something";
  }
}

TEST(Level, WhatAQueryFindsDoesNotDependOnTheLevelsBefore) {
  const auto grid = basin({{-3, -3, 0}, {-2, -4, 8}}, 6);
  const auto plainScene = prepare(sceneWithFragments(Eigen::Vector3d(0, 0, -9.81)), grid);
  ASSERT_TRUE(plainScene);
  const auto scene = leveled(**plainScene);
  ContactGathering jumping(scene);
  std::vector<Eigen::Isometry3d> X_WB(scene->bodies.size(), Eigen::Isometry3d::Identity());
  const Eigen::Isometry3d X_WT = isometry(pressed(*scene, 0).pose);
  std::vector<std::vector<std::size_t>> counts;
  for (const std::size_t level : {0U, 1U, 2U, 3U, 4U}) {
    ContactGathering fresh(scene);
    fresh.setLevel(level);
    fresh.gather(X_WT, X_WB);
    for (int round = 0; round < 5; ++round) {
      jumping.setLevel(static_cast<std::size_t>(4 - round));
      jumping.gather(X_WT, X_WB);
    }
    jumping.setLevel(level);
    jumping.gather(X_WT, X_WB);
    ASSERT_EQ(jumping.ofTool().size(), fresh.ofTool().size());
    EXPECT_EQ(jumping.betweenBodies(), fresh.betweenBodies());
    EXPECT_EQ(jumping.tests(), fresh.tests());
    for (std::size_t i = 0; i < fresh.ofTool().size(); ++i) {
      EXPECT_EQ(std::memcmp(jumping.ofTool()[i].p, fresh.ofTool()[i].p, sizeof(double[3])), 0);
      EXPECT_EQ(jumping.ofTool()[i].depth, fresh.ofTool()[i].depth);
    }
  }
}

TEST(Level, NumbersThatAreNoLevelBecomeOneAndWithoutLevelsNothingHappens) {
  const auto scene = leveled(*prepared(ball()));
  Simulation simulation(scene, CouplingGains{});
  const auto after = [&simulation](double value) {
    simulation.apply({Command::Kind::SetLevel, value});
    return simulation.level();
  };
  EXPECT_EQ(after(3.0), 3u);
  EXPECT_EQ(after(std::nan("")), 0u);
  EXPECT_EQ(after(1e300), 4u);
  EXPECT_EQ(after(-7.0), 0u);
  EXPECT_EQ(after(2.9), 2u);
  Simulation none(prepared(ball()), CouplingGains{});
  none.apply({Command::Kind::SetLevel, 3});
  EXPECT_EQ(none.level(), 0u);
  EXPECT_EQ(none.record().commandCount, 1u);
}

TEST(Level, TheUsersImpulsesCountAtLevelsThatAreNotAboutThem) {
  const auto scene = leveled(*prepared(ball()));
  const auto impulses = [&scene](double user, double level) {
    Simulation simulation(scene, CouplingGains{});
    simulation.apply({Command::Kind::SetSolverIterations, user});
    simulation.apply({Command::Kind::SetLevel, level});
    std::uint32_t most = 0;
    for (std::uint64_t i = 0; i < 300; ++i) {
      most = std::max(most, simulation.step(pressed(*scene, i)).impulses);
    }
    return most;
  };
  EXPECT_LE(impulses(2, 0), 2u);
  EXPECT_LE(impulses(2, 1), 2u);
  EXPECT_LE(impulses(2, 2), 2u);
  EXPECT_LE(impulses(1000, 1), 3u);
  EXPECT_GT(impulses(1000, 0), 3u);
}

TEST(Level, TheSnapshotTellsTheLevelItsNameAndSinceWhen) {
  const auto scene = leveled(*prepared(ball()));
  Simulation simulation(scene, CouplingGains{});
  auto snapshot = std::make_unique<Snapshot>();
  for (std::uint64_t i = 0; i < 10; ++i) (void)simulation.step(pressed(*scene, i));
  simulation.fill(*snapshot);
  EXPECT_EQ(snapshot->levels, 5u);
  EXPECT_EQ(snapshot->level, 0u);
  EXPECT_STREQ(snapshot->levelName.data(), "level 0");
  EXPECT_EQ(snapshot->levelChanges, 0u);
  simulation.apply({Command::Kind::SetLevel, 2});
  simulation.apply({Command::Kind::SetLevel, 2});
  (void)simulation.step(pressed(*scene, 10));
  simulation.fill(*snapshot);
  EXPECT_EQ(snapshot->level, 2u);
  EXPECT_STREQ(snapshot->levelName.data(), "level 2");
  EXPECT_EQ(snapshot->levelChanges, 1u);
  EXPECT_NEAR(snapshot->levelSince, 0.010, 1e-12);
}

TEST(Level, WhatIsNoLadderIsRefused) {
  const auto scene = prepared(ball());
  const auto refusal = [&scene](const std::function<void(std::vector<GovernorLevel>&)>& spoil) {
    auto levels = someLevels(scene->scene.setting);
    spoil(levels);
    const auto made = withLevels(*scene, levels);
    return made ? "accepted" : made.error().field.value_or("");
  };
  EXPECT_EQ(refusal([](auto&) {}), "accepted");
  EXPECT_EQ(refusal([](auto& l) { l.clear(); }), "accepted");
  EXPECT_EQ(refusal([](auto& l) { l.resize(kMostLevels + 1, l[0]); }), "levels");
  EXPECT_EQ(refusal([](auto& l) { l[0].perceptualBound = 1e-3; }), "levels.0");
  EXPECT_EQ(refusal([](auto& l) { l[2].stepP99_us = l[1].stepP99_us; }), "levels.2.step_p99_us");
  EXPECT_EQ(refusal([](auto& l) { l[1].forceErrorP95_N = 1; }), "levels.2.force_error_p95_N");
  EXPECT_EQ(refusal([](auto& l) { l[3].stepP99_us = std::nan(""); }), "levels.3");
  EXPECT_EQ(refusal([](auto& l) { l[4].stepP99_us = 0.0; }), "levels.4");
  EXPECT_EQ(refusal([](auto& l) { l[2].perceptualBound = -1; }), "levels.2");
  EXPECT_EQ(refusal([](auto& l) { l[2].solverIterations = 0; }), "levels.2");
  const auto made = withLevels(*scene, someLevels(scene->scene.setting));
  const auto rows = [](const PreparedScene& s) {
    const PlanRow* found = nullptr;
    for (const PlanRow& row : s.plan) found = row.what == "governor" ? &row : found;
    return *found;
  };
  EXPECT_FALSE(rows(*scene).modelled);
  EXPECT_EQ(rows(*scene).bytes, 0u);
  EXPECT_TRUE(rows(**made).modelled);
  EXPECT_GT(rows(**made).bytes, 4 * 100 * scene->shell->size());
}

}  // namespace
}  // namespace palpate
