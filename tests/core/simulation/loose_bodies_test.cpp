#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/simulation/loose_parts.h"
#include "core/simulation/simulation.h"
#include "tests/core/simulation/fragment_scene.h"

namespace palpate {
namespace {

double energyOf(const Simulation& simulation, const Eigen::Vector3d& gravity) {
  double energy = 0.0;
  for (const LooseBody& body : simulation.bodies()) {
    energy += body.body().kineticEnergy() - body.body().mass() * gravity.dot(body.body().centre());
  }
  return energy;
}

/// How deep the bodies are in bone and in each other, by brute force over the voxel grids.
double deepestOf(const PreparedScene& scene, const Simulation& simulation) {
  double deepest = 0.0;
  std::vector<Contact> contacts(5000);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const PreparedBody& body = scene.bodies[i];
    QueryOptions brute;
    brute.method = QueryMethod::BruteForce;
    const Eigen::Isometry3d X_WB = simulation.bodies()[i].X_WB();
    ContactFinder bone(*scene.tree, *body.shell, brute);
    std::size_t n = bone.find(scene.X_WV.inverse() * X_WB, contacts).contactCount;
    for (std::size_t c = 0; c < n; ++c) deepest = std::max(deepest, contacts[c].depth);
    for (std::size_t j = 0; j < scene.bodies.size(); ++j) {
      if (i == j) continue;
      const Eigen::Isometry3d X_WV =
          simulation.bodies()[j].X_WB() * scene.bodies[j].tree->geometry().X_PV;
      ContactFinder other(*scene.bodies[j].tree, *body.shell, brute);
      n = other.find(X_WV.inverse() * X_WB, contacts).contactCount;
      for (std::size_t c = 0; c < n; ++c) deepest = std::max(deepest, contacts[c].depth);
    }
  }
  return deepest;
}

TEST(LooseParts, AreTheConnectedOnesEachInItsPlace) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  auto grid = syntheticGrid([](double, double, double) { return false; });
  std::size_t solid = 0;
  for (auto& label : grid->labels) {
    label = random() % 100 < 6 ? kFragment : 0;
    solid += label != 0 ? 1 : 0;
  }
  std::vector<std::uint8_t> found(grid->labels.size(), 0);
  const auto parts = looseParts(*grid, kFragment, {"fragment", true, 0.0});
  std::size_t count = 0;
  for (const LabelGrid& part : parts) {
    const GridGeometry& g = part.geometry;
    for (std::int32_t k = 0; k < g.dims[2]; ++k) {
      for (std::int32_t j = 0; j < g.dims[1]; ++j) {
        for (std::int32_t i = 0; i < g.dims[0]; ++i) {
          if (part.at(i, j, k) == 0) continue;
          ++count;
          const Eigen::Vector3d p_V =
              grid->geometry.X_PV.inverse() * (g.X_PV * g.centre_V(i, j, k));
          const auto v = grid->geometry.voxelAt(p_V);
          ASSERT_TRUE(grid->geometry.contains(v[0], v[1], v[2]));
          const std::size_t at = grid->geometry.index(v[0], v[1], v[2]);
          ASSERT_EQ(grid->labels[at], kFragment);
          ASSERT_EQ(found[at], 0) << "seed " << kSeed;
          found[at] = 1;
        }
      }
    }
  }
  EXPECT_EQ(count, solid);
  // No voxel of one part touches one of another: paint parts, look at all neighbours.
  std::vector<std::size_t> partOf(grid->labels.size(), 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const GridGeometry& g = parts[p].geometry;
    for (std::size_t n = 0; n < parts[p].labels.size(); ++n) {
      if (parts[p].labels[n] == 0) continue;
      const auto nx = static_cast<std::size_t>(g.dims[0]), ny = static_cast<std::size_t>(g.dims[1]);
      const Eigen::Vector3d p_P =
          g.X_PV * g.centre_V(static_cast<double>(n % nx), static_cast<double>(n / nx % ny),
                              static_cast<double>(n / (nx * ny)));
      const auto v = grid->geometry.voxelAt(grid->geometry.X_PV.inverse() * p_P);
      partOf[grid->geometry.index(v[0], v[1], v[2])] = p + 1;
    }
  }
  const auto& dims = grid->geometry.dims;
  for (std::int32_t k = 0; k + 1 < dims[2]; ++k) {
    for (std::int32_t j = 1; j + 1 < dims[1]; ++j) {
      for (std::int32_t i = 1; i + 1 < dims[0]; ++i) {
        const std::size_t a = partOf[grid->geometry.index(i, j, k)];
        if (a == 0) continue;
        for (int n = 0; n < 27; ++n) {
          const std::int32_t x = i + n % 3 - 1, y = j + n / 3 % 3 - 1, z = k + n / 9 - 1;
          if (!grid->geometry.contains(x, y, z)) continue;
          const std::size_t b = partOf[grid->geometry.index(x, y, z)];
          ASSERT_TRUE(b == 0 || a == b);
        }
      }
    }
  }
  EXPECT_EQ(looseParts(*grid, kFragment, {"fragment", false, 0.0}).size(), 1u);
  EXPECT_LT(looseParts(*grid, kFragment, {"fragment", true, 5.0}).size(), parts.size());
  EXPECT_TRUE(looseParts(*grid, 9, {"other", true, 0.0}).empty());
}

TEST(LooseBodies, AreCutOutOfTheAnatomyAndHaveTheirOwnMass) {
  const auto grid = basin({{-3, -3, 10}, {5, 5, 10}}, 6);
  const auto with = prepare(sceneWithFragments({0, 0, 0}), grid);
  ASSERT_TRUE(with) << sentence(with.error());
  auto boneOnly = std::make_shared<LabelGrid>(*grid);
  for (auto& label : boneOnly->labels) label = label == kFragment ? 0 : label;
  EXPECT_EQ((*with)->tree->stats().solidVoxels, prepared(boneOnly)->tree->stats().solidVoxels);
  ASSERT_EQ((*with)->bodies.size(), 2u);
  EXPECT_EQ((*with)->bodies[0].name, "fragment 1");
  EXPECT_EQ((*with)->bodies[1].name, "fragment 2");
  // 6^3 voxels of 1 mm³ of bone at 1900 kg/m³.
  EXPECT_NEAR((*with)->bodies[0].massProperties.mass, 216e-9 * 1900.0, 1e-12);
  // Bone on bone catches more than steel on bone.
  EXPECT_EQ((*with)->bodies[0].surface[kBone].friction, 0.5);
  EXPECT_EQ((*with)->instrumentSurface[kBone].friction, 0.25);
}

TEST(LooseBodies, WhatCannotMoveIsRefusedByName) {
  const auto message = [](const Scene& scene, std::shared_ptr<const LabelGrid> grid) {
    const auto made = prepare(scene, std::move(grid));
    return made ? std::string("accepted")
                : made.error().message + "|" + made.error().field.value_or("") + "|" +
                      made.error().found.value_or("");
  };
  Scene scene = sceneWithFragments({0, 0, 0});
  EXPECT_EQ(message(scene, basin({}, 1)),
            "A loose body has no voxel, or none of its parts is large enough.|body.fragment|");
  scene.bodies[0].label = "stone";
  EXPECT_EQ(message(scene, basin({{0, 0, 10}}, 4)),
            "A loose body is of a label that the case does not have.|body.stone|stone");
  scene.bodies[0].label = "bone";
  EXPECT_EQ(message(scene, basin({}, 1)), "None of the scene's labels has a voxel.|labels|");
  auto many = basin({}, 1);
  for (std::size_t i = 0; i < many->labels.size(); i += 3 * 64 + 7) {
    many->labels[i] = many->labels[i] == 0 ? kFragment : many->labels[i];
  }
  Scene grains = sceneWithFragments({0, 0, 0});
  grains.bodies[0].leastVolume_mm3 = 0.0;
  EXPECT_EQ(message(grains, many).rfind("There are too many loose bodies.|body.fragment|", 0), 0u);
}

TEST(LooseBodies, FragmentsFallIntoABasinAndComeToRestOnEachOther) {
  const auto grid = basin({{-3, -3, 0}, {-2, -4, 8}, {-5, -2, 16}}, 6);
  const Eigen::Vector3d down = grid->geometry.X_PV.linear() * Eigen::Vector3d(0, 0, -9.81);
  const auto scene = prepare(sceneWithFragments(down), grid);
  ASSERT_TRUE(scene) << sentence(scene.error());
  Simulation simulation(*scene, CouplingGains{});
  const double start = energyOf(simulation, down);
  double energy = start, deepest = 0.0;
  std::size_t touching = 0;
  for (std::uint64_t i = 0; i < 6000; ++i) {
    (void)simulation.step(farAway(**scene, i));
    const double now = energyOf(simulation, down);
    // All that may come in is the lift out of a penetration, 0.1 mm a step for bodies of 0.4 g; a
    // kick would be thousands of times more.
    ASSERT_LE(now, energy + 3 * 0.41e-3 * 9.81 * 1e-4) << i;
    ASSERT_LE(now, start) << i;
    energy = now;
    touching = std::max<std::size_t>(touching, simulation.record().contactsBetweenBodies);
    if (i % 50 == 0 && i > 0) deepest = std::max(deepest, deepestOf(**scene, simulation));
  }
  EXPECT_GT(touching, 3u);
  EXPECT_LE(deepest, 1e-3) << "a voxel at most while they fall";
  EXPECT_LE(deepestOf(**scene, simulation), 0.5e-3) << "half a voxel at rest";
  std::vector<Eigen::Vector3d> before;
  for (const LooseBody& body : simulation.bodies()) before.push_back(body.body().centre());
  for (std::uint64_t i = 6000; i < 7000; ++i) (void)simulation.step(farAway(**scene, i));
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LE((simulation.bodies()[i].body().centre() - before[i]).norm(), 1e-4)
        << "drift, body " << i;
    EXPECT_LT(simulation.bodies()[i].body().velocity().norm(), 2e-3) << i;
  }
}

TEST(LooseBodies, TheInstrumentPushesThemAndFeelsThem) {
  const auto grid = basin({{-3, -3, 12}}, 6);
  const auto scene = prepare(sceneWithFragments({0, 0, 0}), grid);
  ASSERT_TRUE(scene) << sentence(scene.error());
  Simulation simulation(*scene, CouplingGains{});
  const Eigen::Vector3d target = simulation.bodies()[0].body().centre();
  // From above, along the basin's axis, 30 mm in half a second.
  const Eigen::Vector3d down = grid->geometry.X_PV.linear() * Eigen::Vector3d(0, 0, -1);
  const Eigen::Quaterniond tipDown =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), -down);
  double force = 0.0;
  bool touchedBody = false;
  for (std::uint64_t i = 0; i < 500; ++i) {
    DeviceSample sample;
    sample.index = i;
    const Eigen::Vector3d p = target + down * (0.06e-3 * static_cast<double>(i) - 0.010);
    sample.pose = plain(p, tipDown);
    const StepRecord& step = simulation.step(sample);
    force = std::max(
        force, std::hypot(step.contact.force[0], step.contact.force[1], step.contact.force[2]));
    for (const Contact& c : simulation.contacts_W()) touchedBody = touchedBody || c.body == 1;
  }
  EXPECT_TRUE(touchedBody);
  EXPECT_GT(force, 0.0);
  EXPECT_GT((simulation.bodies()[0].body().centre() - target).dot(down), 0.005);
}

TEST(LooseBodies, SameSamplesSameBitsAndSnapshotsShowTheirPoses) {
  const auto grid = basin({{-3, -3, 0}, {-2, -4, 8}}, 6);
  const Eigen::Vector3d down = grid->geometry.X_PV.linear() * Eigen::Vector3d(0, 0, -9.81);
  const auto scene = prepare(sceneWithFragments(down), grid);
  ASSERT_TRUE(scene) << sentence(scene.error());
  Simulation a(*scene, CouplingGains{}), b(*scene, CouplingGains{});
  for (std::uint64_t i = 0; i < 300; ++i) {
    (void)a.step(farAway(**scene, i));
    (void)b.step(farAway(**scene, i));
  }
  EXPECT_EQ(a.record().stateHash, b.record().stateHash);
  auto snapshot = std::make_unique<Snapshot>();
  a.fill(*snapshot);
  ASSERT_EQ(snapshot->bodies, 2u);
  const Eigen::Vector3d p = a.bodies()[1].X_WB().translation();
  EXPECT_EQ(position(snapshot->body[1]), p);
  EXPECT_GT(p.norm(), 1e-3);
}

}  // namespace
}  // namespace palpate
