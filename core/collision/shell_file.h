#pragma once
/// A point shell from a PLY file (interface.md, `collide --shell`).
///
/// PLY 1.0, ascii or binary_little_endian. The element `vertex` needs the scalar properties x, y,
/// z (millimetres) and nx, ny, nz (outward normals of any length); others are passed over, and so
/// are the elements after it. Points keep the order of the file.

#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/collision/point_shell.h"

namespace palpate {

/// Refuses, by file and line (ascii) or vertex (binary): other formats, missing properties, a file
/// that is cut short, what is not a finite number, a normal without a direction.
[[nodiscard]] Result<PointShell> readShellFile(const std::filesystem::path& file);
/// The same from bytes; `name` is the file's for the messages.
[[nodiscard]] Result<PointShell> parseShell(std::string_view bytes, const std::string& name);

}  // namespace palpate
