#include "core/collision/trajectory_file.h"

#include <Eigen/SVD>
#include <array>
#include <cmath>

#include "core/collision/input_file.h"
#include "core/collision/text_cursor.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

constexpr std::string_view kHeading = "step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz";
constexpr std::size_t kFields = 13;
constexpr double kRotationTolerance = 1e-5;  // interface.md

Error atLine(const std::string& name, std::size_t line, std::string message) {
  return inputRefused("Line " + std::to_string(line) + " of the poses: " + std::move(message))
      .inFile(name);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::string_view fieldName(std::size_t index) {
  return split(kHeading)[index];
}

Result<void> checkHeading(std::string_view line, const std::string& name) {
  if (split(line) == split(kHeading)) return {};
  return fail(atLine(name, 1, "the heading is not that of a pose file.")
                  .butFound(std::string(line.substr(0, 80)))
                  .wants(std::string(kHeading))
                  .advise("Write this heading as the first line, then a pose a line."));
}

Result<Eigen::Matrix3d> nearestRotation(const Eigen::Matrix3d& R, const std::string& name,
                                        std::size_t line) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  const double off = (R - rotation).cwiseAbs().maxCoeff();
  if (rotation.determinant() < 0.0) {
    return fail(atLine(name, line, "r00 to r22 mirror; they are not a rotation.")
                    .inField("r00..r22")
                    .advise("Give a right-handed rotation."));
  }
  if (off > kRotationTolerance) {
    return fail(atLine(name, line, "r00 to r22 are not a rotation.")
                    .inField("r00..r22")
                    .butFound("off by " + std::to_string(off))
                    .wants("a rotation within 0.00001")
                    .advise("Write the rotation with at least six digits."));
  }
  return rotation;
}

Result<TrajectoryPose> parsePose(std::string_view text, const std::string& name, std::size_t line) {
  const auto fields = split(text);
  if (fields.size() != kFields) {
    return fail(atLine(name, line, "the count of fields is wrong.")
                    .butFound(std::to_string(fields.size()))
                    .wants(std::to_string(kFields)));
  }
  TrajectoryPose pose;
  const auto step = numberOf<std::int64_t>(fields[0]);
  if (!step) {
    return fail(atLine(name, line, "the step is not a whole number.")
                    .inField("step")
                    .butFound(std::string(fields[0].substr(0, 40))));
  }
  pose.step = *step;
  std::array<double, kFields - 1> value{};
  for (std::size_t f = 1; f < kFields; ++f) {
    const auto number = numberOf<double>(fields[f]);
    if (!number || !std::isfinite(*number)) {
      return fail(atLine(name, line, "a field is not a finite number.")
                      .inField(std::string(fieldName(f)))
                      .butFound(std::string(fields[f].substr(0, 40))));
    }
    value[f - 1] = *number;
  }
  Eigen::Matrix3d R;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    for (std::size_t column = 0; column < 3; ++column) {
      R(r, static_cast<Eigen::Index>(column)) = value[4 * row + column];
    }
    pose.X_WT.translation()[r] = metres(value[4 * row + 3]);
  }
  const auto rotation = nearestRotation(R, name, line);
  if (!rotation) return fail(rotation.error());
  pose.X_WT.linear() = *rotation;
  return pose;
}

}  // namespace

Result<std::vector<TrajectoryPose>> parseTrajectory(std::string_view text,
                                                    const std::string& name) {
  LineReader lines(text);
  const auto heading = lines.next();
  if (auto ok = checkHeading(heading.value_or(""), name); !ok) return fail(ok.error());
  std::vector<TrajectoryPose> poses;
  while (const auto line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    auto pose = parsePose(*line, name, lines.number());
    if (!pose) return fail(pose.error());
    poses.push_back(*pose);
  }
  if (poses.empty()) {
    return fail(inputRefused("The file has no poses.")
                    .inFile(name)
                    .advise("Write a pose a line after the heading."));
  }
  return poses;
}

Result<std::vector<TrajectoryPose>> readTrajectory(const std::filesystem::path& file) {
  const auto text = readInputFile(file);
  if (!text) return fail(text.error());
  return parseTrajectory(*text, file.string());
}

}  // namespace palpate
