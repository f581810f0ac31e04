#pragma once
/// The tools that make and mend a label, as plain values: what the window, the command and a recipe
/// have in common. imaging/segment/apply.h carries them out.
///
/// Positions are in P (patient, DICOM LPS), millimetres; lengths millimetres; values those of the
/// volume (HU for CT), ranges inclusive. A voxel is where its centre is.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "imaging/segmentation.h"

namespace palpate::tool {

/// Everything in the range. Replaces the label.
struct Threshold {
  ThresholdRange range;
  bool largestOnly = false;
  double minMm3 = 0.0;
};

/// The 26-connected parts of the range that hold a seed, no farther than `reach_mm` (0: anywhere)
/// from the nearest seed. Adds to the label.
struct GrowRegion {
  std::vector<Eigen::Vector3d> seeds_mm;
  ThresholdRange range;
  double reach_mm = 0.0;
};

/// What becomes of the label's 26-connected parts.
struct Islands {
  enum class Keep : std::uint8_t {
    Largest,   ///< Only the `count` largest.
    AtLeast,   ///< Those of `minMm3` or more.
    Picked,    ///< Those at `picks_mm` (the part's voxel nearest to a pick, within 5 mm).
    NotPicked  ///< All but those.
  } keep = Keep::Largest;
  std::size_t count = 1;
  double minMm3 = 0.0;
  std::vector<Eigen::Vector3d> picks_mm;
};

/// Fills what the label encloses: 6-connected background that does not reach the edge of the scan
/// and is no larger than `maxMm3` (0: of any size). Other labels inside stay as they are.
struct FillHoles {
  double maxMm3 = 0.0;
};

/// Grows or shrinks by a ball: a voxel is within `mm` of another when their centres are. Open is
/// erode then dilate, close the reverse. Only voxels of the scan count: nothing grows or shrinks
/// from the scan's edge.
struct Margin {
  enum class Operation : std::uint8_t { Dilate, Erode, Open, Close } operation = Operation::Dilate;
  double mm = 1.0;
};

/// A Gaussian of standard deviation `mm`, cut at one half. With `keepThin`, sheets and bars that
/// the blur would thin or tear stay as they were: what an opening by `mm` takes away and that is
/// at least six times `mm` long stays labelled; smaller grains and bumps go.
struct Smooth {
  double mm = 1.0;
  bool keepThin = true;
};

/// Takes away what is inside (or outside) the box, whose faces are part of it; axes of P.
struct Box {
  Eigen::Vector3d low_mm = Eigen::Vector3d::Zero(), high_mm = Eigen::Vector3d::Zero();
  bool keepInside = false;
  bool allLabels = false;  ///< Crops every label, not only this one.
};

/// Takes away what is seen inside (or outside) an outline drawn on a view. `view` maps a point of
/// P in mm, (x, y, z, 1), to (u w, v w, w); the outline is closed, in (u, v), even-odd. Points with
/// w <= 0 are behind the eye and stay.
struct Scissors {
  Eigen::Matrix<double, 3, 4> view = Eigen::Matrix<double, 3, 4>::Zero();
  std::vector<Eigen::Vector2d> outline;
  bool keepInside = false;
  /// Only where `plane_mm` · (x, y, z, 1) is within ± `depth_mm`; without, all the way through.
  std::optional<Eigen::Vector4d> plane_mm;
  double depth_mm = 0.0;
};

/// A stroke: balls along a polyline, or, with a `normal`, disks one voxel thick across it.
struct Brush {
  std::vector<Eigen::Vector3d> path_mm;
  double radius_mm = 2.0;
  std::optional<Eigen::Vector3d> normal;
  bool erase = false;
};

/// Shares the label between itself and other labels by seeds: floods it from all seeds at once,
/// bright before dark (`Brightness`: parts meet where the joint is darkest) or smooth before steep
/// (`Edges`: they meet where grey values change most). A connected part without a seed stays. The
/// voxels of the label within `radius_mm` of a seed are seeds too, so that a click on the dark rim
/// of a bone is as good as one in its middle.
struct Split {
  struct Seeds {
    std::string label;  ///< Becomes this label; the label that is split: stays.
    std::vector<Eigen::Vector3d> points_mm;
  };
  std::vector<Seeds> seeds;
  double radius_mm = 0.0;
  enum class By : std::uint8_t { Brightness, Edges } by = By::Brightness;
};

/// Arithmetic with another label grown by `grown_mm` (as Margin does). Labels never overlap, so
/// without growth Add merges the other into this one, and Subtract changes nothing. Add takes over
/// the other's voxels; the other's row stays.
struct Combine {
  enum class Operation : std::uint8_t { Add, Subtract, Intersect } operation = Operation::Add;
  std::string other;
  double grown_mm = 0.0;
};

/// Takes the label away, and its row in the table.
struct Remove {};

}  // namespace palpate::tool

namespace palpate {

using LabelTool = std::variant<tool::Threshold, tool::GrowRegion, tool::Islands, tool::FillHoles,
                               tool::Margin, tool::Smooth, tool::Box, tool::Scissors, tool::Brush,
                               tool::Split, tool::Combine, tool::Remove>;

/// What a tool may touch.
struct EditLimits {
  bool overOthers = false;             ///< May take voxels of other labels (Threshold always may).
  std::optional<ThresholdRange> only;  ///< Only voxels of these values change.
};

/// One step of a recipe, of the window's history.
struct LabelStep {
  std::string label;
  LabelTool tool;
  EditLimits limits;
  std::optional<std::string> preset;  ///< Of a Threshold whose range the volume decides.
};

/// "Threshold", "Fill holes": a word for lists and progress.
[[nodiscard]] std::string toolTitle(const LabelTool& tool);

}  // namespace palpate
