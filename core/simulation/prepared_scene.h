#pragma once
/// A scene made ready to run: the tree built, the shell sampled, the device placed.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/dynamics/contact_response.h"
#include "core/scene/instrument.h"
#include "core/scene/material.h"
#include "core/scene/scene.h"
#include "core/simulation/governor_ladder.h"
#include "core/simulation/reach.h"
#include "core/voxels/label_grid.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

/// One row of what the scene models or leaves out (simulate --explain). Costs are what it takes, or
/// what it would take were it modelled, as far as that is known.
struct PlanRow {
  std::string what;
  bool modelled = false;
  std::string why;
  std::size_t bytes = 0;
  std::optional<double> us = std::nullopt;  ///< µs a step in contact; filled in by measuredPlan().
};

/// A loose body: voxels of one label, cut out of the anatomy. Its frame B is W where it starts.
struct PreparedBody {
  std::string name;                         ///< "fragment 2"
  std::uint8_t label = 0;                   ///< Of the case's table: colour and material.
  std::shared_ptr<const LabelGrid> voxels;  ///< Its own box of voxels; non-zero is the body.
  std::shared_ptr<const VoxelTree> tree;    ///< In the box's frame.
  std::shared_ptr<const PointShell> shell;  ///< In B: centres of surface voxels.
  MassProperties massProperties;            ///< In B.
  SurfaceTable surface;                     ///< What it meets, by label.
};

/// Shared, read-only, outlives every run of it. World W = patient P, metres.
struct PreparedScene {
  Scene scene;
  Instrument instrument;
  /// Within the region; kept so that a session can carry its own anatomy.
  std::shared_ptr<const LabelGrid> labels;
  std::shared_ptr<const LabelGrid> wholeLabels;  ///< As given; null where no region cuts them.
  LabelTable table;
  std::vector<Material> materials;
  std::shared_ptr<const VoxelTree> tree;  ///< Of what can be reached (reach.h).
  ReachSaving saving;
  ReachLimit reachLimit = ReachLimit::None;
  std::shared_ptr<const PointShell> shell;
  std::vector<PreparedBody> bodies;  ///< Empty where the scene declares none.
  Eigen::Isometry3d X_WV = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  std::array<Material, 256> materialOf;  ///< By label value.
  SurfaceTable instrumentSurface;        ///< What the instrument meets, by label.
  std::vector<GovernorLevel> levels;     ///< Of withLevels(); empty: no governor.
  std::vector<PlanRow> plan;
  std::uint64_t fingerprint = 0;  ///< Of labels, instrument and setting; in the session.
};

/// Refuses a label that the table does not have, a case in which nothing is labelled, and a region
/// or a device that holds or reaches nothing of what is. The tree is opened from, or left in, a
/// cache file in `treeCache`, a case's folder, unless that is empty.
[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> prepareScene(
    const Scene& scene, std::shared_ptr<const LabelGrid> labels, const LabelTable& table,
    const std::vector<Material>& materials, const Instrument& instrument,
    const Progress& progress = {}, const std::filesystem::path& treeCache = {});

/// The same scene, sharing its tree and shells, with a ladder for the governor: the first level is
/// the scene's own setting, times fall and errors do not, at most kMostLevels. Refuses any other.
/// No levels: as without a governor. Each level whose query differs takes a contact finder a pair
/// that may touch, when a run starts: 110 to 140 bytes a shell point.
[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> withLevels(
    const PreparedScene& prepared, std::vector<GovernorLevel> levels);

}  // namespace palpate
