#pragma once
/// Which kind of volume file it is, by its first bytes.

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.h"

namespace palpate {

enum class VolumeFormat { Nifti, Nrrd, MetaImage };

/// Empty when the file is none of them or cannot be read. Looks at content only.
[[nodiscard]] std::optional<VolumeFormat> volumeFormatByContent(const std::filesystem::path& file);
/// By extension, for writing. Refuses (usage) others with the list.
[[nodiscard]] Result<VolumeFormat> volumeFormatByName(const std::filesystem::path& file);
/// "NIfTI", "NRRD", "MetaImage".
[[nodiscard]] const char* formatName(VolumeFormat format);

/// The first bytes of a file, decompressed when it is gzip; fewer when the file ends.
[[nodiscard]] std::string firstBytes(const std::filesystem::path& file, std::size_t count);

}  // namespace palpate
