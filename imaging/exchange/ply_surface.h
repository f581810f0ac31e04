#pragma once
/// The triangles of a PLY file (text, or binary of either byte order).

#include <optional>
#include <string_view>

#include "imaging/exchange/label_surface.h"

namespace palpate {

/// Not welded; corners may point past the vertices. Empty where the bytes are no PLY file with x, y
/// and z of vertices and lists of their indices, or end before what the header states.
[[nodiscard]] std::optional<SurfaceMesh> parsePly(std::string_view bytes);

}  // namespace palpate
