#include <algorithm>

#include "imaging/segment/edit.h"

namespace palpate {
namespace {

/// Sets kA where the other label is, grown.
Result<void> markOther(const Edit& edit, std::uint8_t other, double grown_mm, MaskBlock& block) {
  const VoxelBox& box = block.box;
  const std::uint8_t first = grown_mm > 0.0 ? plane::kB : plane::kA;
  forEachRow(edit.geometry(), box,
             [&](std::size_t from, std::int32_t count, std::int32_t y, std::int32_t z) {
               std::uint8_t* row =
                   block.voxels.data() + block.index(0, y - box.low[1], z - box.low[2]);
               for (std::int32_t x = 0; x < count; ++x) {
                 if (edit.labels.labels[from + static_cast<std::size_t>(x)] == other) {
                   row[x] |= first;
                 }
               }
             });
  if (grown_mm == 0.0) return {};
  return dilate(block, plane::kB, plane::kA, grown_mm, edit.share("Growing the other label"));
}

/// The other's own voxels go over whatever the limits say of other labels: that is what is asked.
void takeOver(const Edit& edit, std::uint8_t other) {
  forEachRow(edit.geometry(), wholeBox(edit.geometry()),
             [&](std::size_t first, std::int32_t count, std::int32_t, std::int32_t) {
               for (std::size_t i = first; i < first + static_cast<std::size_t>(count); ++i) {
                 std::uint8_t& label = edit.labels.labels[i];
                 if (label == other && edit.mayChange(i)) label = edit.value;
               }
             });
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::Combine& tool) {
  using Operation = tool::Combine::Operation;
  if (auto fits = within(tool.grown_mm, 0.0, kMostMm, "grown_mm"); !fits) return fits;
  const auto row = std::find_if(edit.table.begin(), edit.table.end(),
                                [&](const LabelInfo& l) { return l.name == tool.other; });
  if (row == edit.table.end() || row->value == edit.value) {
    return fail(inputRefused("There is no other label of that name.")
                    .inField("other")
                    .butFound(tool.other)
                    .wants("the name of another label of the case")
                    .advise("Choose one of the case's labels."));
  }
  const std::uint8_t other = row->value;
  const VoxelBox box =
      grownBy(unite(boundsOf(edit.labels, edit.value), boundsOf(edit.labels, other)), tool.grown_mm,
              edit.geometry());
  if (box.empty()) {
    return fail(inputRefused("Both labels are empty.").inField("other").butFound(tool.other));
  }
  MaskBlock block = blockOf(edit.labels, edit.value, box);
  if (auto marked = markOther(edit, other, tool.grown_mm, block); !marked) return marked;
  for (std::uint8_t& voxel : block.voxels) {
    const bool mine = (voxel & plane::kMask) != 0, covered = (voxel & plane::kA) != 0;
    const bool wanted = tool.operation == Operation::Add        ? mine || covered
                        : tool.operation == Operation::Subtract ? mine && !covered
                                                                : mine && covered;
    voxel = wanted ? plane::kMask : std::uint8_t{0};
  }
  if (tool.operation == Operation::Add) takeOver(edit, other);
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
