#pragma once
/// The motions that every setting of a sweep is put through.
///
/// Device samples in W, one a servo tick (1 ms), velocities those of the path. Same scene and seed,
/// same bits. The tool comes tip first.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/haptics/messages.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/reference_shape.h"

namespace palpate {

struct Trajectory {
  std::string name;  ///< "approach", "slide 7", "cavity 7", "random 7", a session's file name.
  std::vector<DeviceSample> samples;
  /// Sample from which on the hand is still; samples.size(): it never is.
  std::size_t restFrom = 0;
  bool smooth = true;  ///< Of a path without jumps: its force has to be smooth, too.
};

/// Where rays towards the anatomy come from.
struct Surround {
  Eigen::Vector3d centre_W = Eigen::Vector3d::Zero();
  double radius = 0.0;                              ///< m, holds all that is felt.
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitY();  ///< +y of the device.
  double leastCosine = -1.0;                        ///< Of a direction with up: -1 from anywhere.
  /// A few points of the instrument: what touches first on the way in. The tip alone would let a
  /// hand push a burr far into the rim of a narrow hole.
  std::vector<Eigen::Vector3d> points_T{Eigen::Vector3d::Zero()};
};
/// The felt voxels' own centroid and extent, some 150 points of the scene's shell.
[[nodiscard]] Surround surroundOf(const PreparedScene& scene);

/// 10 mm down along -y of D to 1.5 mm below its origin within a second; then still for 0.3 s.
[[nodiscard]] Trajectory approachPath(const PreparedScene& scene);
/// Down as well, within 0.4 s, then half a second to and fro within 8 mm. The seed turns and times
/// the slide.
[[nodiscard]] Trajectory slidePath(const PreparedScene& scene, std::uint64_t seed);
/// Into the most enclosed place that the tool gets to on twelve of 100 random ways in, those whose
/// tip alone ends most enclosed, to 1.5 mm behind the first touch,
/// then round it while the tool tilts by 10 degrees; 0.8 s. Empty where no way meets anything.
[[nodiscard]] Trajectory cavityPath(const ReferenceShape& shape, const Surround& surround,
                                    std::uint64_t seed);
/// As in the paper's Figure 6: from a random direction towards the centre at an even 50 mm/s, from
/// 8 mm before to 1.5 mm behind the first touch; then still for 0.1 s. Empty where the
/// ray meets nothing.
[[nodiscard]] Trajectory randomPath(const ReferenceShape& shape, const Surround& surround,
                                    std::uint64_t seed);

/// What the hand did in a recorded session, by its file's name.
[[nodiscard]] Result<Trajectory> sessionPath(const std::filesystem::path& file);

}  // namespace palpate
