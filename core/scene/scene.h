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
  /// Of the coupling's recommended stiffness, 0.1 to 1: all of it is measured stable with any grip.
  double couplingShare = 1.0;
};

/// A label whose voxels move, instead of standing still with the rest of the anatomy.
struct SceneBody {
  std::string label;
  bool separate = true;          ///< Each connected part (faces, edges, corners) by itself.
  double leastVolume_mm3 = 1.0;  ///< Smaller parts are left out: grains of the segmentation.
};

/// What acts on loose bodies besides contacts.
struct Surroundings {
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< m/s², W.
  /// 1/s: share of its velocity that a body loses a second, for the blood and tissue around it.
  double drag = 10.0;
};

/// A box along the axes of its frame, as the scene file has it.
struct SceneBox {
  Eigen::Vector3d least_mm = Eigen::Vector3d::Zero(), most_mm = Eigen::Vector3d::Zero();
};

/// What of the anatomy is left out of the tree because no instrument gets there
/// (core/simulation/reach.h says exactly when).
enum class Reach : std::uint8_t {
  All,     ///< Nothing.
  Sealed,  ///< Cavities without a way in.
  Device   ///< Those, and what is too far from the device's workspace.
};

struct Scene {
  std::string name;
  std::vector<std::string> labels;  ///< Felt labels, by name in labels.toml; empty: all.
  /// Patient axes (P). Voxels whose centre is outside are background; empty: the whole grid.
  std::optional<SceneBox> region;
  Reach reach = Reach::Sealed;
  /// Where the stylus can be, in D; for Reach::Device. Empty: whoever opens the scene fills it in
  /// with the device's own.
  std::optional<SceneBox> workspace;
  std::string instrument = "ball-burr";
  std::string device = "touch-x";  ///< The simulated model when no hardware is there.
  /// Where the device's workspace centre stands in W (= P, metres). Empty: over the anatomy's
  /// surface, chosen from the labels by planApproach().
  std::optional<Eigen::Isometry3d> X_WD;
  std::vector<SceneBody> bodies;  ///< Loose bodies; empty: nothing but the instrument moves.
  Surroundings surroundings;
  SimulationSetting setting;
};

/// The most loose bodies of a scene: each pair of them has a contact query of its own in memory.
inline constexpr std::size_t kMostBodies = 64;

[[nodiscard]] Result<Scene> readScene(const std::filesystem::path& file);
/// Whole or not at all.
[[nodiscard]] Result<void> writeScene(const Scene& scene, const std::filesystem::path& file);

}  // namespace palpate
