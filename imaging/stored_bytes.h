#pragma once
/// Whether a volume file holds all the bytes that its header states.
///
/// ITK fills what is missing from a short NIfTI or MetaImage file without a word; this looks first.

#include <cstdint>
#include <filesystem>
#include <span>

#include "imaging/volume_format.h"

namespace palpate {

/// True when all voxels are there and compressed streams end as they should, check sums included.
/// NRRD is left to ITK, which notices. Reads compressed files through once; any thread.
[[nodiscard]] bool holdsAllVoxels(VolumeFormat format, const std::filesystem::path& file,
                                  std::uint64_t voxels, std::uint64_t bytesPerVoxel);
/// Whether the file's last bytes are these. Reads the file in blocks.
[[nodiscard]] bool endsWithBytes(const std::filesystem::path& file, std::span<const char> bytes);

}  // namespace palpate
