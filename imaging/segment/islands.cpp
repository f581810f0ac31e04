#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "imaging/components.h"
#include "imaging/segment/edit.h"
#include "imaging/segment/nearest_label.h"

namespace palpate {
namespace {

/// How far a pick may be from the part that it means.
constexpr double kPickMm = 5.0;

std::vector<bool> largest(const MaskParts& parts, std::size_t count) {
  std::vector<std::uint32_t> order(parts.voxels.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&parts](std::uint32_t a, std::uint32_t b) {
    return parts.voxels[a] > parts.voxels[b];
  });
  std::vector<bool> kept(parts.voxels.size(), false);
  for (std::size_t i = 0; i < std::min(count, order.size()); ++i) kept[order[i]] = true;
  return kept;
}

Result<std::vector<bool>> picked(const Edit& edit, const tool::Islands& tool,
                                 const MaskParts& parts, const MaskBlock& block) {
  std::vector<bool> chosen(parts.voxels.size(), false);
  for (std::size_t i = 0; i < tool.picks_mm.size(); ++i) {
    const std::string field = "picks[" + std::to_string(i) + "]";
    if (const auto in = voxelOf(edit, tool.picks_mm[i], field); !in) return fail(in.error());
    const auto nearest = nearestOf(edit.labels, edit.value, tool.picks_mm[i], kPickMm);
    if (!nearest) {
      return fail(inputRefused("No part of the label is near the pick.")
                      .inField(field)
                      .wants("a point within 5 mm of the label")
                      .advise("Click on the part itself."));
    }
    const auto voxel = voxelOf(edit, *nearest, field);
    if (!voxel) return fail(voxel.error());
    chosen[partOf(parts, block, *voxel).value()] = true;
  }
  return chosen;
}

Result<std::vector<bool>> keptParts(const Edit& edit, const tool::Islands& tool,
                                    const MaskParts& parts, const MaskBlock& block) {
  using Keep = tool::Islands::Keep;
  if (tool.keep == Keep::Largest) return largest(parts, tool.count);
  std::vector<bool> kept(parts.voxels.size(), false);
  if (tool.keep == Keep::AtLeast) {
    const double mm3 = block.spacing_mm.prod();
    for (std::size_t i = 0; i < kept.size(); ++i) {
      // A volume that was read off a list is the part's own, so rounding must not drop it.
      kept[i] = static_cast<double>(parts.voxels[i]) * mm3 >= tool.minMm3 * (1.0 - 1e-9);
    }
    return kept;
  }
  auto chosen = picked(edit, tool, parts, block);
  if (chosen && tool.keep == Keep::NotPicked) chosen->flip();
  return chosen;
}

Result<void> check(const tool::Islands& tool) {
  using Keep = tool::Islands::Keep;
  if (tool.keep == Keep::Largest) return within(static_cast<double>(tool.count), 1, 1e9, "count");
  if (tool.keep == Keep::AtLeast) return within(tool.minMm3, 0, 1e12, "min_mm3");
  if (!tool.picks_mm.empty()) return {};
  return fail(usageError("No part is picked.").inField("picks").advise("Pick at least one part."));
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::Islands& tool) {
  if (auto fits = check(tool); !fits) return fits;
  MaskBlock block = blockOf(edit.labels, edit.value, boundsOf(edit.labels, edit.value));
  const Share share = edit.share("Finding connected parts");
  share.at(0.2);
  const MaskParts parts = findParts(block.voxels, block.dims, {.bits = plane::kMask});
  if (edit.progress.cancelled()) return fail(cancelled());
  share.at(0.8);
  const auto kept = keptParts(edit, tool, parts, block);
  if (!kept) return fail(kept.error());
  std::vector<bool> dropped = *kept;
  dropped.flip();
  fillParts(parts, dropped, 0, block.dims[0], block.voxels);
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
