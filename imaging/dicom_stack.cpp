#include "imaging/dicom_stack.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>

#include "imaging/volume.h"

namespace palpate {
namespace {

// Positions are written with six or seven digits; a scanner's own rounding stays below this. It is
// a twentieth of the finest voxel in use, and anything above it is tilt, a gap or damage.
constexpr double kPlaceTolerance_mm = 0.05;
// Two images nearer than this lie at the same place.
constexpr double kSamePlace_mm = 0.01;
// A tenth of a micrometre, and a kilometre: beyond them a header is damaged.
constexpr double kMinSpacing_mm = 1e-4;
constexpr double kMaxPosition_mm = 1e6;

std::string millimetres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", value);
  return text;
}

DicomProblem geometryProblem(const DicomFrame& f) {
  const std::string nothing = "no such numbers";
  const std::string spacing = "two lengths from 0.0001 to 1000 mm";
  const std::string place = "three coordinates within a kilometre";
  const std::string directions = "two perpendicular directions of length 1";
  if (!f.hasSpacing) return {"it states no pixel spacing", "PixelSpacing", nothing, spacing};
  if (!(f.spacing_mm.minCoeff() >= kMinSpacing_mm) || f.spacing_mm.maxCoeff() > 1000.0) {
    return {"its pixel spacing is not a length", "PixelSpacing",
            dicomNumbers({f.spacing_mm.y(), f.spacing_mm.x()}), spacing};
  }
  if (!f.hasPosition) {
    return {"it states no position in the patient", "ImagePositionPatient", nothing, place};
  }
  if (f.position_mm.cwiseAbs().maxCoeff() > kMaxPosition_mm) {
    return {"its position is far outside of any scanner", "ImagePositionPatient",
            dicomNumbers({f.position_mm.x(), f.position_mm.y(), f.position_mm.z()}), place};
  }
  if (!f.hasOrientation) {
    return {"it states no orientation in the patient", "ImageOrientationPatient", nothing,
            directions};
  }
  const bool square = std::abs(f.row.norm() - 1.0) < 1e-3 &&
                      std::abs(f.column.norm() - 1.0) < 1e-3 &&
                      std::abs(f.row.dot(f.column)) < 1e-3;
  if (!square) {
    return {
        "its orientation is not two perpendicular directions", "ImageOrientationPatient",
        dicomNumbers({f.row.x(), f.row.y(), f.row.z(), f.column.x(), f.column.y(), f.column.z()}),
        directions};
  }
  if (f.slope == 0.0) {
    return {"its rescale slope is zero", "RescaleSlope", "0", "any other number"};
  }
  return {};
}

Eigen::Matrix3d rotationOf(const DicomFrame& frame) {
  Eigen::Matrix3d axes;
  axes << frame.row.normalized(), frame.column.normalized(),
      frame.row.cross(frame.column).normalized();
  if ((axes * axes.transpose()).isIdentity(1e-12)) return axes;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

StackShape shapeOf(const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& normal) {
  StackShape shape;
  const std::size_t n = positions.size();
  if (n < 2) return shape;
  const Eigen::Vector3d whole = positions.back() - positions.front();
  const double length = whole.dot(normal);
  shape.spacing_mm = length / static_cast<double>(n - 1);
  shape.minGap_mm = shape.maxGap_mm = (positions[1] - positions[0]).dot(normal);
  const Eigen::Vector3d across = whole - length * normal;
  shape.tilt_deg = std::atan2(across.norm(), length) * 180.0 / std::numbers::pi;
  for (std::size_t i = 1; i < n; ++i) {
    const Eigen::Vector3d way = positions[i] - positions.front();
    const double along = way.dot(normal);
    const double gap = (positions[i] - positions[i - 1]).dot(normal);
    shape.minGap_mm = std::min(shape.minGap_mm, gap);
    shape.maxGap_mm = std::max(shape.maxGap_mm, gap);
    shape.unevenness_mm =
        std::max(shape.unevenness_mm, std::abs(along - shape.spacing_mm * static_cast<double>(i)));
    shape.sideways_mm = std::max(shape.sideways_mm, (way - along * normal).norm());
  }
  return shape;
}

/// Sorts along the normal and sets images of one place aside.
void orderSlices(const std::vector<DicomFile>& files, const Eigen::Vector3d& normal,
                 std::vector<FrameRef> frames, DicomStack& stack) {
  const auto height = [&](const FrameRef& r) { return frameOf(files, r).position_mm.dot(normal); };
  std::stable_sort(frames.begin(), frames.end(),
                   [&](const FrameRef& a, const FrameRef& b) { return height(a) < height(b); });
  for (const FrameRef& ref : frames) {
    if (!stack.slices.empty() &&
        (frameOf(files, ref).position_mm - frameOf(files, stack.slices.back()).position_mm).norm() <
            kSamePlace_mm) {
      stack.duplicates.push_back(ref);
      stack.duplicateOf.push_back(stack.slices.size() - 1);
    } else {
      stack.slices.push_back(ref);
    }
  }
}

/// Each file may state a large empty image; all of a stack are not empty.
DicomProblem problemOfVolume(const std::vector<DicomFile>& files, const DicomStack& stack) {
  const std::string size = std::to_string(stack.geometry.dims[0]) + " x " +
                           std::to_string(stack.geometry.dims[1]) + " x " +
                           std::to_string(stack.geometry.dims[2]);
  if (stack.geometry.voxelCount() > kMaxVoxels) {
    return {"it has more voxels than Palpate holds (2^31)", "Columns, Rows, slices", size,
            "at most 2^31 voxels"};
  }
  std::set<std::size_t> members;
  for (const FrameRef& ref : stack.slices) members.insert(ref.file);
  std::uint64_t bytes = 0;
  for (const std::size_t member : members) bytes += files[member].bytes;
  if (stack.geometry.voxelCount() <= std::max(4 * kFreePixels, bytes * kMaxPixelsPerByte)) {
    return {};
  }
  return {"its files are far too small for the images that they state", "Columns, Rows, slices",
          size + " in " + std::to_string(bytes) + " bytes",
          "at most " + std::to_string(kMaxPixelsPerByte) + " voxels a byte"};
}

void judgeShape(const std::vector<DicomFile>& files, DicomStack& stack) {
  const StackShape& s = stack.shape;
  stack.problem = problemOfVolume(files, stack);
  if (!stack.problem.empty()) return;
  if (s.minGap_mm < kSamePlace_mm && stack.slices.size() > 1) {
    stack.problem = {"several of its images share one plane at different places",
                     "ImagePositionPatient", "two images " + millimetres(s.minGap_mm) + " apart",
                     "one image a plane"};
    return;
  }
  if (s.tilted()) {
    char text[160];
    std::snprintf(
        text, sizeof text,
        "its slices are sheared against their normal by %.1f degrees (gantry tilt), up to "
        "%.1f mm",
        s.tilt_deg, s.sideways_mm);
    stack.problem.reason = text;
  }
  if (s.uneven()) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "its slices are %.3g to %.3g mm apart (uneven spacing or missing slices)",
                  s.minGap_mm, s.maxGap_mm);
    stack.problem.reason += (stack.problem.empty() ? "" : "; ") + std::string(text);
  }
  stack.needsRepair = !stack.problem.empty();
  if (!stack.needsRepair && std::max(s.sideways_mm, s.unevenness_mm) > 1e-3) {
    stack.warnings.push_back("The positions in the files differ from a regular box by up to " +
                             millimetres(std::max(s.sideways_mm, s.unevenness_mm)) + ".");
  }
}

}  // namespace

bool StackShape::tilted() const noexcept {
  return sideways_mm > kPlaceTolerance_mm;
}

bool StackShape::uneven() const noexcept {
  return unevenness_mm > kPlaceTolerance_mm;
}

std::string StackShape::repairs() const {
  if (tilted() && uneven()) return "tilt,spacing";
  return tilted() ? "tilt" : "spacing";
}

const DicomFrame& frameOf(const std::vector<DicomFile>& files, const FrameRef& ref) {
  return files[ref.file].frames[ref.frame];
}

DicomStack makeStack(const std::vector<DicomFile>& files, const std::vector<FrameRef>& frames) {
  DicomStack stack;
  stack.uid = files[frames.front().file].seriesUid;
  stack.scout = std::all_of(frames.begin(), frames.end(),
                            [&](const FrameRef& r) { return files[r.file].localizer; });
  const DicomFrame& first = frameOf(files, frames.front());
  for (const FrameRef& ref : frames) {
    stack.problem = geometryProblem(frameOf(files, ref));
    if (!stack.problem.empty()) {
      stack.slices = frames;
      return stack;
    }
  }
  const Eigen::Matrix3d axes = rotationOf(first);
  orderSlices(files, axes.col(2), frames, stack);
  std::vector<Eigen::Vector3d> positions;
  for (const FrameRef& ref : stack.slices) positions.push_back(frameOf(files, ref).position_mm);
  stack.shape = shapeOf(positions, axes.col(2));
  GridGeometry& g = stack.geometry;
  g.dims = {static_cast<std::int32_t>(files[frames.front().file].columns),
            static_cast<std::int32_t>(files[frames.front().file].rows),
            static_cast<std::int32_t>(stack.slices.size())};
  double thickness = stack.shape.spacing_mm;
  if (stack.slices.size() == 1) {
    thickness = first.thickness_mm > 0.0 && first.thickness_mm < 1000.0 ? first.thickness_mm : 1.0;
    stack.warnings.push_back(
        "The thickness of the one slice is taken as " + millimetres(thickness) +
        (thickness == first.thickness_mm ? ", as stated." : "; none is stated."));
  }
  g.spacing = Eigen::Vector3d(first.spacing_mm.x(), first.spacing_mm.y(), thickness) * 1e-3;
  g.X_PV.linear() = axes;
  g.X_PV.translation() = positions.front() * 1e-3;
  judgeShape(files, stack);
  return stack;
}

std::string modalityOf(const std::vector<DicomFile>& files, const DicomStack& stack) {
  const bool other = std::any_of(stack.slices.begin(), stack.slices.end(), [&](const FrameRef& r) {
    return isOtherThanHounsfield(files[r.file], frameOf(files, r));
  });
  return other ? "OT" : files[stack.slices.front().file].modality;
}

}  // namespace palpate
