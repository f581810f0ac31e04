#pragma once
/// Triangles from STL (binary or text), PLY (text or binary) and OBJ files.
///
/// Readers of our own: those of VTK trust what a header states. Time and memory follow the file's
/// bytes.

#include <filesystem>

#include "core/base/error.h"
#include "imaging/exchange/exchange_format.h"
#include "imaging/exchange/label_surface.h"

namespace palpate {

/// Welded, in LPS: a file that says SPACE=RAS, as 3D Slicer may, is turned. Polygons become fans of
/// triangles; normals, colours and textures are left out. Refused: damaged or short files, no
/// triangles, corners that are not there, coordinates that are not numbers.
[[nodiscard]] Result<SurfaceMesh> readSurface(const std::filesystem::path& file,
                                              ExchangeFormat format);

}  // namespace palpate
