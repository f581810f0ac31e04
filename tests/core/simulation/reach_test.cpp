#include "core/simulation/reach.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "core/geometry/pose.h"
#include "core/simulation/plan.h"
#include "core/simulation/plan_cost.h"
#include "core/voxels/sealed_cavities.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

constexpr unsigned kSeed = 71;

/// A lump of bone with bumps, pores, cavities and thin shells, all drawn from `random`, of up to
/// three labels.
std::shared_ptr<LabelGrid> randomAnatomy(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
    int label;  // 0: a hole
  };
  std::vector<Ball> balls = {{Eigen::Vector3d::Zero(), 17.0 + 2.0 * unit(random), 1}};
  const auto place = [&]() -> Eigen::Vector3d {
    return Eigen::Vector3d(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5) * 34.0;
  };
  for (int i = 0; i < 6; ++i) balls.push_back({place(), 2.0 + 5.0 * unit(random), 1 + i % 3});
  for (int i = 0; i < 40; ++i) balls.push_back({place(), 0.6 + 4.0 * unit(random), 0});
  auto grid = syntheticGrid([](double, double, double) { return false; }, 48);
  for (int axis = 0; axis < 3; ++axis) {
    grid->geometry.spacing[axis] = 1e-3 * (0.7 + 0.6 * unit(random));
  }
  grid->geometry.X_PV = isometry(plain(Eigen::Vector3d(0.01, -0.2, 0.1),
                                       expMap(Eigen::Vector3d(unit(random), unit(random), 0.3))));
  for (int k = 0; k < 48; ++k) {
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 48; ++i) {
        std::uint8_t& label = grid->labels[grid->geometry.index(i, j, k)];
        for (const Ball& ball : balls) {
          if ((Eigen::Vector3d(i, j, k).array() - 23.5 - ball.centre.array()).matrix().norm() <
              ball.radius) {
            label = static_cast<std::uint8_t>(ball.label);
          }
        }
      }
    }
  }
  return grid;
}

LabelTable threeLabels() {
  return {{"bone", 1, {227, 211, 177}, "bone"},
          {"tooth", 2, {1, 2, 3}, "tooth"},
          {"nerve", 3, {3, 2, 1}, "nerve"}};
}

std::shared_ptr<const PreparedScene> make(const std::shared_ptr<const LabelGrid>& grid,
                                          const Scene& scene) {
  auto made =
      prepareScene(scene, grid, threeLabels(), datasetMaterials(), datasetInstrument("hook-probe"));
  EXPECT_TRUE(made) << sentence(made.error());
  return made ? *made : nullptr;
}

/// Contacts of a scene's instrument, pose after pose.
class Query {
 public:
  explicit Query(const PreparedScene& scene)
      : finder_(*scene.tree, *scene.shell, scene.scene.setting.query),
        X_VW_(scene.X_WV.inverse()),
        room_(scene.shell->size()) {}
  std::span<const Contact> at(const Eigen::Isometry3d& X_WT) {
    return {room_.data(), finder_.find(X_VW_ * X_WT, room_).contactCount};
  }

 private:
  ContactFinder finder_;
  Eigen::Isometry3d X_VW_;
  std::vector<Contact> room_;
};

bool sameBits(const Contact& a, const Contact& b) {
  return a.shellIndex == b.shellIndex && std::memcmp(a.p, b.p, sizeof(a.p)) == 0 &&
         std::memcmp(a.n, b.n, sizeof(a.n)) == 0 &&
         std::memcmp(&a.depth, &b.depth, sizeof(a.depth)) == 0 && a.label == b.label &&
         a.flags == b.flags;
}

double deepest(std::span<const Contact> contacts) {
  double depth = 0.0;
  for (const Contact& contact : contacts) depth = std::max(depth, contact.depth);
  return depth;
}

/// Poses with the tip about a random voxel's centre, by up to a voxel and a half.
Eigen::Isometry3d randomPose(const LabelGrid& grid, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::uniform_int_distribution<std::size_t> any(0, grid.labels.size() - 1);
  std::size_t at = any(random);
  const auto n = static_cast<std::size_t>(grid.geometry.dims[0]);
  // A free voxel with a solid one beside it: that is where tools are.
  while (at + n >= grid.labels.size() || grid.labels[at] != 0 ||
         (grid.labels[at + 1] == 0 && grid.labels[at + n] == 0)) {
    at = any(random);
  }
  const Eigen::Vector3d p_P =
      grid.geometry.X_PV * grid.geometry.centre_V(static_cast<double>(at % n),
                                                  static_cast<double>(at / n % n),
                                                  static_cast<double>(at / n / n));
  const Eigen::Vector3d turn(unit(random), unit(random), unit(random));
  const Eigen::Vector3d off(unit(random), unit(random), unit(random));
  return isometry(plain(p_P + 1e-3 * off, expMap(3.0 * turn)));
}

void expectSameContacts(LeafModel leaf, Reach reach) {
  ::testing::Test::RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::size_t compared = 0, withContacts = 0, filled = 0, cavities = 0;
  for (int anatomy = 0; anatomy < 12; ++anatomy) {
    const auto grid = randomAnatomy(random);
    Scene scene;
    scene.reach = Reach::All;
    scene.setting.tree.leaf = leaf;
    const auto whole = make(grid, scene);
    scene.reach = reach;
    scene.workspace = SceneBox{{-500, -500, -500}, {500, 500, 500}};
    const auto pruned = make(grid, scene);
    ASSERT_TRUE(whole && pruned);
    filled += pruned->saving.cavitiesFilled;
    cavities += pruned->saving.cavities;
    if (pruned->saving.filledVoxels > 0) {
      EXPECT_LT(pruned->tree->stats().surfaceVoxels, whole->tree->stats().surfaceVoxels);
      EXPECT_NE(pruned->fingerprint, whole->fingerprint);
    }
    const double half = kReachedDepth * grid->geometry.spacing.minCoeff();
    Query ofWhole(*whole), ofPruned(*pruned);
    for (int i = 0; i < 1500; ++i) {
      const Eigen::Isometry3d X_WT = randomPose(*grid, random);
      const auto b = ofPruned.at(X_WT);
      if (deepest(b) >= half) continue;  // deeper than a tool gets
      const auto a = ofWhole.at(X_WT);
      ++compared;
      withContacts += !b.empty();
      ASSERT_EQ(a.size(), b.size()) << "anatomy " << anatomy << ", pose " << i;
      for (std::size_t c = 0; c < a.size(); ++c) {
        ASSERT_TRUE(sameBits(a[c], b[c])) << "anatomy " << anatomy << ", pose " << i << ": depth "
                                          << a[c].depth << " and " << b[c].depth;
      }
    }
  }
  EXPECT_GT(compared, 2000U);
  EXPECT_GT(withContacts, 500U);
  // Walls here are thin, and voxel leaves read farther into them.
  EXPECT_GE(filled, leaf == LeafModel::Distance ? 20U : 3U) << "of " << cavities;
  std::printf("%zu poses, %zu of them in contact; %zu of %zu cavities filled; seed %u\n", compared,
              withContacts, filled, cavities, kSeed);
}

TEST(Reach, DistanceLeavesGiveTheSameContactsWithoutSealedCavities) {
  expectSameContacts(LeafModel::Distance, Reach::Sealed);
}

TEST(Reach, VoxelLeavesGiveTheSameContactsWithoutSealedCavities) {
  expectSameContacts(LeafModel::Voxel, Reach::Sealed);
}

/// A plate of 8 mm with a cavity in it, 3 mm below its upper face.
std::shared_ptr<LabelGrid> plateWithCavity(double size_mm = 4.0) {
  return syntheticGrid([size_mm](double x, double y, double z) {
    const bool plate = std::abs(x) < 28 && std::abs(y) < 28 && z > -24 && z < 24;
    const bool cavity = std::abs(x) < size_mm && std::abs(y) < size_mm && z < 21 && z > 17;
    return plate && !cavity;
  });
}

TEST(Reach, PastTheMiddleOfAWallTheFillingPushesBackOut) {
  // What the definition says of a tool pressed through: the whole anatomy lets it into the cavity,
  // the filled one has only one way out.
  const auto grid = plateWithCavity();
  Scene scene;
  scene.reach = Reach::All;
  const auto whole = prepared(grid, scene);
  scene.reach = Reach::Sealed;
  const auto filled = prepared(grid, scene);
  EXPECT_EQ(filled->saving.cavitiesFilled, 1U);
  const auto at = [&](const PreparedScene& s, double below_mm) {
    // One point at a place: the ball burr's tip.
    const Eigen::Vector3d top = grid->geometry.X_PV * grid->geometry.centre_V(31.5, 31.5, 55.0);
    const auto one = PointShell::fromPoints({Eigen::Vector3d::Zero()}, {-Eigen::Vector3d::UnitZ()});
    ContactFinder finder(*s.tree, *one, s.scene.setting.query);
    Contact contact;
    Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
    X_WT.translation() = top - Eigen::Vector3d(0, 0, 1e-3 * (below_mm - 0.5));
    const auto found = finder.find(s.X_WV.inverse() * X_WT, {&contact, 1});
    return found.contactCount == 0 ? Contact{} : contact;
  };
  for (const double below : {0.1, 0.4, 0.9, 1.4}) {
    EXPECT_TRUE(sameBits(at(*whole, below), at(*filled, below))) << below;
    EXPECT_GT(at(*filled, below).n[2], 0.99);
  }
  EXPECT_LT(at(*whole, 2.5).n[2], -0.99);  // on into the cavity
  EXPECT_GT(at(*filled, 2.5).n[2], 0.99);
  EXPECT_EQ(at(*whole, 4.0).depth, 0.0);  // in it
  EXPECT_NEAR(at(*filled, 4.0).depth, 4.0e-3, 1e-4);
}

TEST(Reach, ACavityThatTheInstrumentFitsIntoStays) {
  const auto grid = syntheticGrid([](double x, double y, double z) {
    const double r = std::sqrt(x * x + y * y + z * z);
    return r < 30 && (r > 25 || r < 2);
  });
  Scene scene;
  const auto burr = prepared(grid, scene);  // 35 mm of it and more: between 50 mm of walls
  const auto length = [](const PreparedScene& s) {
    Eigen::AlignedBox3d box;
    for (const auto& p : s.shell->points_T()) box.extend(p);
    return box.sizes().maxCoeff();
  };
  EXPECT_EQ(burr->saving.cavities, 1U);
  EXPECT_EQ(burr->saving.cavitiesFilled, length(*burr) > 0.0901 ? 1U : 0U);
  Instrument little = datasetInstrument();
  for (auto& vertex : little.mesh_T.vertices) vertex *= 0.2;
  little.shellSpacing = 0.2e-3;
  const auto made = prepareScene(scene, grid, boneTable(), datasetMaterials(), little);
  ASSERT_TRUE(made);
  EXPECT_LT(length(**made), 0.05);
  EXPECT_EQ((*made)->saving.cavitiesFilled, 0U);
}

TEST(Reach, ACavityWithALooseBodyInItStays) {
  auto grid = plateWithCavity();
  Scene scene;
  EXPECT_EQ(prepared(grid, scene)->saving.cavitiesFilled, 1U);
  for (int k = 50; k < 52; ++k) {
    for (int j = 31; j < 33; ++j) {
      for (int i = 31; i < 33; ++i) {
        ASSERT_EQ(grid->at(i, j, k), 0);
        grid->labels[grid->geometry.index(i, j, k)] = 2;
      }
    }
  }
  scene.bodies = {{"tooth", true, 1.0}};
  const auto made = make(grid, scene);
  ASSERT_EQ(made->bodies.size(), 1U);
  EXPECT_EQ(made->saving.cavities, 1U);
  EXPECT_EQ(made->saving.cavitiesFilled, 0U);
}

TEST(Reach, WhereDescentIsCutNothingIsLeftOut) {
  Scene scene;
  scene.setting.query.stopLevel = 1;
  const auto made = prepared(plateWithCavity(), scene);
  EXPECT_EQ(made->reachLimit, ReachLimit::CutDescent);
  EXPECT_EQ(made->saving.filledVoxels, 0U);
}

const PlanRow* rowNamed(const std::vector<PlanRow>& plan, const char* what) {
  const auto found =
      std::find_if(plan.begin(), plan.end(), [what](const PlanRow& r) { return r.what == what; });
  return found == plan.end() ? nullptr : &*found;
}

TEST(Reach, BeyondTheDeviceNothingIsInTheTreeAndWithinNothingChanges) {
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  // A bar of 160 mm; the device stands at one end of it with a short tool.
  auto grid = std::make_shared<LabelGrid>();
  grid->geometry.dims = {320, 20, 20};
  grid->labels.assign(grid->geometry.voxelCount(), 0);
  for (int k = 4; k < 16; ++k) {
    for (int j = 4; j < 16; ++j) {
      for (int i = 2; i < 318; ++i) {
        grid->labels[grid->geometry.index(i, j, k)] = (i * 7 + j * 3 + k) % 11 < 9 ? 1 : 0;
      }
    }
  }
  Instrument little = datasetInstrument();
  for (auto& vertex : little.mesh_T.vertices) vertex *= 0.2;
  little.shellSpacing = 0.2e-3;
  Scene scene;
  scene.X_WD = Eigen::Isometry3d::Identity();
  scene.X_WD->translation() = Eigen::Vector3d(0.01, 0.01, 0.02);
  scene.workspace = SceneBox{{-20, -20, -20}, {20, 20, 20}};
  for (const LeafModel leaf : {LeafModel::Distance, LeafModel::Voxel}) {
    scene.setting.tree.leaf = leaf;
    scene.reach = Reach::Sealed;
    const auto whole = prepareScene(scene, grid, boneTable(), datasetMaterials(), little);
    scene.reach = Reach::Device;
    const auto near = prepareScene(scene, grid, boneTable(), datasetMaterials(), little);
    ASSERT_TRUE(whole && near);
    EXPECT_GT((*near)->saving.outsideDevice, 10000U);
    const PlanRow* row = rowNamed((*near)->plan, kWorkspaceRow);
    ASSERT_NE(row, nullptr);
    EXPECT_FALSE(row->modelled);
    EXPECT_EQ(row->why,
              std::to_string((*near)->saving.outsideDevice) + " labelled voxels left out");
    EXPECT_LT((*near)->tree->stats().payloadBytes, (*whole)->tree->stats().payloadBytes);
    std::size_t touching = 0;
    Query ofWhole(**whole), ofNear(**near);
    for (int i = 0; i < 3000; ++i) {
      // Anywhere in the workspace and the margin beyond.
      const Eigen::Vector3d p = 0.069 * Eigen::Vector3d(unit(random), unit(random), unit(random));
      const Eigen::Isometry3d X_WT =
          *scene.X_WD *
          isometry(plain(Eigen::Vector3d(p.x(), 0.1 * p.y(), 0.1 * p.z()),
                         expMap(3.0 * Eigen::Vector3d(unit(random), unit(random), 0.0))));
      const auto a = ofWhole.at(X_WT), b = ofNear.at(X_WT);
      touching += !a.empty();
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t c = 0; c < a.size(); ++c) ASSERT_TRUE(sameBits(a[c], b[c]));
    }
    EXPECT_GT(touching, 100U);
  }
  scene.workspace.reset();
  const auto unknown = prepareScene(scene, grid, boneTable(), datasetMaterials(), little);
  EXPECT_EQ((*unknown)->reachLimit, ReachLimit::NoWorkspace);
  EXPECT_EQ((*unknown)->saving.outsideDevice, 0U);
}

TEST(Reach, ADeviceThatReachesNothingIsRefused) {
  Scene scene;
  scene.reach = Reach::Device;
  scene.workspace = SceneBox{{-1, -1, -1}, {1, 1, 1}};
  scene.X_WD = Eigen::Isometry3d::Identity();
  scene.X_WD->translation().x() = 3.0;
  const auto made =
      prepareScene(scene, ball(), boneTable(), datasetMaterials(), datasetInstrument());
  ASSERT_FALSE(made);
  EXPECT_EQ(sentence(made.error()),
            "The device reaches no voxel of the scene's labels. Field: device_pose. "
            "Place the device at the anatomy, or ask for reach = \"sealed\".");
}

TEST(Region, VoxelsWhoseCentreIsOutsideAreNotFelt) {
  const auto grid = ball();
  Scene scene;
  const Eigen::Vector3d middle =
      1e3 * (grid->geometry.X_PV * grid->geometry.centre_V(31.5, 31.5, 31.5));
  scene.region =
      SceneBox{middle - Eigen::Vector3d(50, 50, 50), middle + Eigen::Vector3d(0, 50, 50)};
  const auto half = prepared(grid, scene), whole = prepared(grid);
  EXPECT_EQ(half->tree->stats().solidVoxels, whole->tree->stats().solidVoxels / 2);
  EXPECT_EQ(half->saving.outsideRegion, whole->tree->stats().solidVoxels / 2);
  EXPECT_NE(half->fingerprint, whole->fingerprint);
  // The same as a scan that was cut.
  auto cut = std::make_shared<LabelGrid>(*grid);
  for (int k = 0; k < 64; ++k) {
    for (int j = 0; j < 64; ++j) {
      for (int i = 32; i < 64; ++i) cut->labels[grid->geometry.index(i, j, k)] = 0;
    }
  }
  EXPECT_EQ(half->fingerprint, prepared(cut)->fingerprint);
  EXPECT_EQ(half->labels->labels, cut->labels);
}

TEST(Region, WithNothingInItIsRefused) {
  Scene scene;
  scene.region = SceneBox{{1000, 1000, 1000}, {1001, 1001, 1001}};
  const auto made =
      prepareScene(scene, ball(), boneTable(), datasetMaterials(), datasetInstrument());
  ASSERT_FALSE(made);
  EXPECT_EQ(sentence(made.error()),
            "No voxel of the scene's labels lies in its region. Field: region. "
            "Found: " +
                std::to_string(prepared(ball())->tree->stats().solidVoxels) +
                " voxels outside. Expected: a box in mm, patient axes, that holds some of "
                "them. Correct the region, or remove it from the scene.");
}

TEST(Plan, TellsWhatIsLeftOutAndWhatItWouldCost) {
  const auto scene = prepared(plateWithCavity());
  const auto plan = measuredPlan(scene, WholeTree::Build);
  ASSERT_TRUE(plan) << sentence(plan.error());
  Scene all;
  all.reach = Reach::All;
  const auto bytes = [](const PreparedScene& s) {
    return s.tree->stats().topologyBytes + s.tree->stats().payloadBytes;
  };
  double query = -1, response = -1, motion = -1, friction = -1;
  bool cavities = false;
  for (const PlanRow& row : *plan) {
    EXPECT_FALSE(row.why.empty()) << row.what;
    if (row.what == "contact query") query = row.us.value_or(-1);
    if (row.what == "contact response") response = row.us.value_or(-1);
    if (row.what == "coupling and motion") motion = row.us.value_or(-1);
    if (row.what == "friction") friction = row.us.value_or(-1);
    if (row.what != "sealed cavities") continue;
    cavities = true;
    EXPECT_FALSE(row.modelled);
    EXPECT_EQ(row.why, "1 of 1 filled, 256 of 256 voxels");
    EXPECT_EQ(row.bytes, bytes(*prepared(plateWithCavity(), all)) - bytes(*scene));
    EXPECT_GT(row.bytes, 0U);
  }
  EXPECT_TRUE(cavities);
  EXPECT_GT(query, 0.0);
  EXPECT_GT(response, 0.0);
  EXPECT_GT(motion, 0.0);
  EXPECT_GE(friction, 0.0);
}

TEST(Plan, WhatASceneDoesNotAskToLeaveOutHasNoRow) {
  const auto scene = prepared(ball());
  EXPECT_EQ(rowNamed(scene->plan, kRegionRow), nullptr);
  EXPECT_EQ(rowNamed(scene->plan, kWorkspaceRow), nullptr);
  EXPECT_EQ(scene->wholeLabels, nullptr);
}

TEST(Plan, ARegionSavesTheBytesOfWhatIsOutside) {
  const auto whole = prepared(ball());
  Scene half;
  const Eigen::Vector3d middle_mm =
      1e3 * (whole->X_WV * whole->labels->geometry.centre_V(32, 32, 32));
  half.region = SceneBox{middle_mm - Eigen::Vector3d::Constant(100),
                         middle_mm + Eigen::Vector3d(0, 100, 100)};
  const auto scene = prepared(ball(), half);
  const auto plan = measuredPlan(scene, WholeTree::Build);
  ASSERT_TRUE(plan) << sentence(plan.error());
  const PlanRow* row = rowNamed(*plan, kRegionRow);
  ASSERT_NE(row, nullptr);
  EXPECT_FALSE(row->modelled);
  EXPECT_EQ(row->why, std::to_string(scene->saving.outsideRegion) + " labelled voxels left out");
  const auto bytes = [](const PreparedScene& s) {
    return s.tree->stats().topologyBytes + s.tree->stats().payloadBytes;
  };
  EXPECT_EQ(row->bytes, bytes(*whole) - bytes(*scene));
  EXPECT_GT(row->bytes, 0U);
}

}  // namespace
}  // namespace palpate
