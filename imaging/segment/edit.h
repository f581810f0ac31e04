#pragma once
/// What applyStep() hands to a tool, and each tool's own work. Not for use outside this folder.

#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/components.h"
#include "imaging/segment/mask_block.h"
#include "imaging/segment/morphology.h"
#include "imaging/segment/tools.h"
#include "imaging/volume.h"

namespace palpate {

/// A label being edited: tools change `labels`, `table` only by new rows. An error leaves both
/// half done; applyStep() works on copies.
struct Edit {
  const Volume& volume;
  LabelGrid& labels;
  LabelTable& table;
  std::uint8_t value;
  const EditLimits& limits;
  const Progress& progress;

  [[nodiscard]] const GridGeometry& geometry() const { return labels.geometry; }
  /// Whether the step's limits let this voxel change at all.
  [[nodiscard]] bool mayChange(std::size_t voxel) const {
    if (!limits.only) return true;
    const double v = volume.value(voxel);
    return v >= limits.only->low && v <= limits.only->high;
  }
  [[nodiscard]] Share share(const char* what) const { return {progress, 0.0, 0.95, what}; }
};

/// Makes the label what the block's kMask says, as far as the limits allow; nothing changes outside
/// the block.
void writeBack(const Edit& edit, const MaskBlock& block);

/// The part of the block in which a voxel of the grid is; nothing where it is in none.
[[nodiscard]] std::optional<std::uint32_t> partOf(const MaskParts& parts, const MaskBlock& block,
                                                  const std::array<std::int32_t, 3>& voxel);

/// The voxel of a point of P, mm; refuses one outside the scan by `field`.
[[nodiscard]] Result<std::array<std::int32_t, 3>> voxelOf(const Edit& edit,
                                                          const Eigen::Vector3d& point_mm,
                                                          const std::string& field);
/// Refuses a number that is not finite or not within [low, high].
[[nodiscard]] Result<void> within(double value, double low, double high, const std::string& field);
/// Refuses a range that is not one.
[[nodiscard]] Result<void> checkRange(const ThresholdRange& range);

/// Largest margin, blur or reach, mm.
inline constexpr double kMostMm = 200.0;

[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Threshold& tool);   // threshold.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::GrowRegion& tool);  // grow_region.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Islands& tool);     // islands.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::FillHoles& tool);   // fill_holes.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Margin& tool);      // margin.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Smooth& tool);      // smooth.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Box& tool);         // cut.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Scissors& tool);    // cut.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Brush& tool);       // brush.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Split& tool);       // split.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Combine& tool);     // combine.cpp
[[nodiscard]] Result<void> carryOut(Edit& edit, const tool::Remove& tool);      // remove.cpp

}  // namespace palpate
