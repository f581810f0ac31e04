// A file of poses is refused with a sentence, or its poses are rigid.

#include <Eigen/LU>

#include "core/collision/trajectory_file.h"
#include "tests/fuzz/fuzz_require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const auto poses =
      parseTrajectory(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.csv");
  if (!poses) {
    require(poses.error().kind == ErrorKind::InputRefused, "a file is refused as an input");
    require(!poses.error().message.empty(), "a refusal has a sentence");
    require(poses.error().file == "fuzz.csv", "a refusal names the file");
    return 0;
  }
  require(!poses->empty(), "a trajectory has a pose");
  for (const TrajectoryPose& pose : *poses) {
    require(pose.X_WT.matrix().allFinite(), "poses are finite");
    const Eigen::Matrix3d R = pose.X_WT.linear();
    require((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-9,
            "rotations are orthonormal");
    require(R.determinant() > 0, "rotations do not mirror");
  }
  return 0;
}
