#include "imaging/segment/edit.h"

namespace palpate {

Result<void> carryOut(Edit& edit, const tool::Threshold& tool) {
  if (auto fits = checkRange(tool.range); !fits) return fits;
  if (auto fits = within(tool.minMm3, 0.0, 1e12, "min_mm3"); !fits) return fits;
  auto selected =
      selectVoxels(edit.volume, {tool.range, tool.largestOnly, tool.minMm3}, edit.progress);
  if (!selected) return fail(selected.error());
  MaskBlock block;
  block.box = wholeBox(edit.geometry());
  block.dims = block.box.dims();
  block.spacing_mm = spacing_mm(edit.geometry());
  block.voxels = std::move(*selected);
  writeBack(edit, block, true);
  return {};
}

}  // namespace palpate
