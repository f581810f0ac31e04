#pragma once
/// labels.toml: the names, values, colours and materials of the labels.

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"

namespace palpate {

[[nodiscard]] std::string labelTableText(const LabelTable& table);
/// Unknown keys, values outside 1..255, names or values used twice: refused by line.
[[nodiscard]] Result<LabelTable> readLabelTable(const std::filesystem::path& file);
/// What makes a table wrong, whoever made it: names, values, colours.
[[nodiscard]] Result<void> checkLabelTable(const LabelTable& table);

}  // namespace palpate
