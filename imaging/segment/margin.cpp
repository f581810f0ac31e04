#include "imaging/segment/edit.h"

namespace palpate {

Result<void> carryOut(Edit& edit, const tool::Margin& tool) {
  using Operation = tool::Margin::Operation;
  if (auto fits = within(tool.mm, 0.0, kMostMm, "mm"); !fits) return fits;
  const bool grows = tool.operation == Operation::Dilate || tool.operation == Operation::Close;
  const bool twice = tool.operation == Operation::Open || tool.operation == Operation::Close;
  // One voxel more: what is eroded next to the box's side has to see what is outside the label.
  const VoxelBox bounds = boundsOf(edit.labels, edit.value);
  VoxelBox box = grownBy(bounds, grows ? tool.mm : 0.0, edit.geometry());
  box = grownBy(box, edit.geometry().spacing.maxCoeff() * 1e3 + (twice ? tool.mm : 0.0),
                edit.geometry());
  MaskBlock block = blockOf(edit.labels, edit.value, box);
  const Share whole = edit.share(grows ? "Growing" : "Shrinking");
  const auto first = grows ? dilate : erode;
  const auto second = grows ? erode : dilate;
  auto done = first(block, plane::kMask, plane::kA, tool.mm, whole.part(0.0, twice ? 0.5 : 1.0));
  if (done && twice) done = second(block, plane::kA, plane::kB, tool.mm, whole.part(0.5, 1.0));
  if (!done) return done;
  copyPlane(block, twice ? plane::kB : plane::kA, plane::kMask);
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
