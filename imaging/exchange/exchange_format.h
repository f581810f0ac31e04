#pragma once
/// The formats in which labels and surfaces are exchanged with other programs.

#include <filesystem>
#include <string>

#include "core/base/error.h"

namespace palpate {

enum class ExchangeFormat { DicomSeg, MetaImage, Nrrd, Stl, Ply, Obj };

/// For writing: .dcm, .mha, .nrrd (.seg.nrrd), .stl, .ply, .obj, in any case. Others: refused
/// (usage) with the list.
[[nodiscard]] Result<ExchangeFormat> exportFormat(const std::filesystem::path& file);
/// For reading: those, .mhd and .nhdr, and whatever its name a file with DICOM's mark. There is no
/// such file, or it is none of these: refused.
[[nodiscard]] Result<ExchangeFormat> importFormat(const std::filesystem::path& file);

/// "DICOM SEG", "MetaImage", "NRRD", "STL", "PLY", "OBJ".
[[nodiscard]] const char* exchangeFormatName(ExchangeFormat format);
/// ".dcm", ".mha", ".seg.nrrd", ".stl", ".ply", ".obj".
[[nodiscard]] const char* exchangeEnding(ExchangeFormat format);
/// One label a file, as triangles.
[[nodiscard]] bool isSurface(ExchangeFormat format);

}  // namespace palpate
