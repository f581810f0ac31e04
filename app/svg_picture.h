#pragma once
/// SVG as PNG, by librsvg.

#include <string>

#include "core/base/error.h"

namespace palpate {

/// At twice the SVG's own size, on what it draws as its ground.
[[nodiscard]] Result<std::string> pngOfSvg(const std::string& svg);

}  // namespace palpate
