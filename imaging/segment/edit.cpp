#include "imaging/segment/edit.h"

#include <cmath>

#include "core/base/short_number.h"

namespace palpate {

void writeBack(const Edit& edit, const MaskBlock& block) {
  const VoxelBox& box = block.box;
  forEachRow(edit.geometry(), box,
             [&](std::size_t first, std::int32_t count, std::int32_t y, std::int32_t z) {
               const std::size_t from = block.index(0, y - box.low[1], z - box.low[2]);
               for (std::size_t x = 0; x < static_cast<std::size_t>(count); ++x) {
                 std::uint8_t& label = edit.labels.labels[first + x];
                 const bool wanted = (block.voxels[from + x] & plane::kMask) != 0;
                 const bool has = label == edit.value;
                 if (wanted == has || (wanted && label != 0 && !edit.limits.overOthers)) continue;
                 if (!edit.mayChange(first + x)) continue;
                 label = wanted ? edit.value : std::uint8_t{0};
               }
             });
}

std::optional<std::uint32_t> partOf(const MaskParts& parts, const MaskBlock& block,
                                    const std::array<std::int32_t, 3>& voxel) {
  const auto& low = block.box.low;
  const auto row =
      static_cast<std::uint32_t>((voxel[2] - low[2]) * block.dims[1] + (voxel[1] - low[1]));
  return partAt(parts, row, voxel[0] - low[0]);
}

Result<std::array<std::int32_t, 3>> voxelOf(const Edit& edit, const Eigen::Vector3d& point_mm,
                                            const std::string& field) {
  const GridGeometry& g = edit.geometry();
  if (point_mm.allFinite() && point_mm.cwiseAbs().maxCoeff() < 1e6) {
    const auto voxel = g.voxelAt(g.X_PV.inverse() * (point_mm * 1e-3));
    if (g.contains(voxel[0], voxel[1], voxel[2])) return voxel;
  }
  return fail(inputRefused("The point is not in the scan.")
                  .inField(field)
                  .butFound(shortNumber(point_mm.x()) + ", " + shortNumber(point_mm.y()) + ", " +
                            shortNumber(point_mm.z()) + " mm")
                  .wants("a point of the scan, patient coordinates (LPS)")
                  .advise("Choose a point on the anatomy."));
}

Result<void> within(double value, double low, double high, const std::string& field) {
  if (std::isfinite(value) && value >= low && value <= high) return {};
  return fail(usageError("The number is out of range.")
                  .inField(field)
                  .butFound(shortNumber(value))
                  .wants(shortNumber(low) + " to " + shortNumber(high))
                  .advise("Choose a number in this range."));
}

Result<void> checkRange(const ThresholdRange& range) {
  if (std::isfinite(range.low) && std::isfinite(range.high) && range.low <= range.high) return {};
  return fail(usageError("The lower end of the range is above the upper end.")
                  .inField("threshold")
                  .butFound(shortNumber(range.low) + " to " + shortNumber(range.high))
                  .wants("low, then high")
                  .advise("Swap the two numbers."));
}

}  // namespace palpate
