#pragma once
/// A label of a case, by the name that a user gave.

#include <cstdint>
#include <string>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Its value; refuses an unknown name with the names that are there.
[[nodiscard]] Result<std::uint8_t> labelValue(const LabelTable& table, const std::string& name);

}  // namespace palpate
