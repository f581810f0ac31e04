#pragma once
/// The labels of a case as `segment` prints them.

#include <string>
#include <vector>

#include "app/command.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// JSON `labels[]`: name, value, voxels, mm3; as text a table.
[[nodiscard]] CommandOutput labelReport(const LabelGrid& labels, const LabelTable& table,
                                        std::vector<std::string> warnings);

}  // namespace palpate
