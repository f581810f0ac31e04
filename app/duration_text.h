#pragma once
/// Durations as people type them.

#include <string>

#include "core/base/error.h"

namespace palpate {

/// "1ms", "500us", "0.001s" to seconds, > 0 and finite. A Usage error names `option`.
[[nodiscard]] Result<double> parseDuration(const std::string& text, const std::string& option);

}  // namespace palpate
