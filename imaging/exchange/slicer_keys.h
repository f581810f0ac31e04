#pragma once
/// The keys by which 3D Slicer names the segments of a .seg.nrrd file.

#include <string>
#include <utility>
#include <vector>

#include "imaging/exchange/found_labels.h"

namespace palpate {

/// Key and text, as in the NRRD header.
using SlicerKeys = std::vector<std::pair<std::string, std::string>>;

[[nodiscard]] SlicerKeys slicerKeys(const LabelGrid& labels, const LabelTable& table);
/// Segments with a usable Segment<n>_LabelValue; of two with one value the first. Any other key is
/// left alone. `changed` as in labelName().
[[nodiscard]] std::vector<FoundLabel> slicerLabels(const SlicerKeys& keys, bool& changed);

}  // namespace palpate
