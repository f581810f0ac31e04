#include "imaging/segment/edit.h"

namespace palpate {

Result<void> carryOut(Edit& edit, const tool::Threshold& tool) {
  if (auto fits = checkRange(tool.range); !fits) return fits;
  if (auto fits = within(tool.minMm3, 0.0, 1e12, "min_mm3"); !fits) return fits;
  auto made = segment(edit.volume, &edit.labels, edit.value,
                      {tool.range, tool.largestOnly, tool.minMm3, edit.limits.only}, edit.progress);
  if (!made) return fail(made.error());
  edit.labels = std::move(*made);
  return {};
}

}  // namespace palpate
