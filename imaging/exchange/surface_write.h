#pragma once
/// A surface as a file; STL and OBJ by VTK's writers. Patient coordinates, LPS, millimetres; the
/// file says so in the words that 3D Slicer looks for (SPACE=LPS).

#include <array>
#include <filesystem>

#include "core/base/error.h"
#include "imaging/exchange/exchange_format.h"
#include "imaging/exchange/label_surface.h"

namespace palpate {

/// STL (binary), PLY (binary, with normals and colour) or OBJ (text, with normals). Whole or not
/// at all, read back and counted before it gets its name.
[[nodiscard]] Result<void> writeSurface(const SurfaceMesh& mesh,
                                        const std::array<std::uint8_t, 3>& colour,
                                        ExchangeFormat format, const std::filesystem::path& file);

}  // namespace palpate
