#pragma once
/// The scene file: what is modelled, and nothing else (scene.toml; unknown keys are errors).

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/collision/contact_finder.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

/// The settings that trade speed for accuracy; recorded with every session.
struct SimulationSetting {
  TreeOptions tree;
  QueryOptions query;
  double shellSpacing = 0.0;              ///< m; 0: the instrument's own.
  double stepPeriod = 1e-3;               ///< s; a whole number of servo periods.
  std::uint32_t contactCapacity = 20000;  ///< Contacts a step can hold.
  std::uint32_t solverIterations = 200;   ///< Impulses a step (paper 3.3.1).
  bool friction = true;
};

struct Scene {
  std::string name;
  std::vector<std::string> labels;  ///< Felt labels, by name in labels.toml; empty: all.
  std::string instrument = "ball-burr";
  std::string device = "touch-x";  ///< The simulated model when no hardware is there.
  /// Where the device's workspace centre stands in W (= P, metres). Empty: over the anatomy's
  /// surface, chosen from the labels by planApproach().
  std::optional<Eigen::Isometry3d> X_WD;
  SimulationSetting setting;
};

[[nodiscard]] Result<Scene> readScene(const std::filesystem::path& file);
/// Whole or not at all.
[[nodiscard]] Result<void> writeScene(const Scene& scene, const std::filesystem::path& file);

}  // namespace palpate
