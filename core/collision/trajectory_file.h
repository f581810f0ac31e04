#pragma once
/// Poses of a tool, from a CSV file (interface.md, `collide --poses`).
///
/// First line `step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz`, then a pose a line: world =
/// R p + t, translations in millimetres. R may be off a rotation by 1e-5 in any element; it is
/// replaced by the nearest rotation (polar decomposition).

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace palpate {

struct TrajectoryPose {
  std::int64_t step = 0;
  Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();  ///< Metres.
};

/// Refuses, by file and line: a wrong heading, a wrong count of fields, what is not a finite
/// number, a matrix that is no rotation; and a file without a pose.
[[nodiscard]] Result<std::vector<TrajectoryPose>> readTrajectory(const std::filesystem::path& file);
/// The same from text; `name` is the file's for the messages.
[[nodiscard]] Result<std::vector<TrajectoryPose>> parseTrajectory(std::string_view text,
                                                                  const std::string& name);

}  // namespace palpate
