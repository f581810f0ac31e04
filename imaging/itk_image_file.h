#pragma once
/// ITK's explicit readers and writers behind plain values.
///
/// Alone in its source file: ITK carries an Eigen of its own that must not meet the system's.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "imaging/volume_format.h"

namespace palpate {

/// Keys and texts of a NRRD header beyond its own fields (3D Slicer's names of segments).
using HeaderTexts = std::vector<std::pair<std::string, std::string>>;

enum class StoredType {
  UInt8,
  Int8,
  UInt16,
  Int16,
  UInt32,
  Int32,
  UInt64,
  Int64,
  Float32,
  Float64,
  Other
};

/// What the header says. Axes beyond the third are in `volumes`.
struct ItkImageHeader {
  std::array<std::uint64_t, 3> dims{1, 1, 1};
  std::uint64_t volumes = 1;
  unsigned components = 1;
  StoredType type = StoredType::Other;
  std::size_t bytesPerValue = 1;
  std::array<double, 3> spacing_mm{1, 1, 1}, origin_mm{0, 0, 0};
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< Column after column, LPS.
  bool saysPatientSpace = true;                                ///< NRRD: has a `space` field.
  HeaderTexts texts;                                           ///< NRRD only.
};

/// Empty when ITK cannot read the header.
[[nodiscard]] std::optional<ItkImageHeader> readItkHeader(VolumeFormat format,
                                                          const std::filesystem::path& file);
/// The voxels as stored; empty when the file is damaged or ends before its last voxel.
[[nodiscard]] std::vector<char> readItkVoxels(VolumeFormat format,
                                              const std::filesystem::path& file);
/// UInt8, Int16 and Float32 only. False when ITK notices a failure; it does not notice them all.
/// `compress` is for MetaImage and NRRD; NIfTI goes by its name.
[[nodiscard]] bool writeItkImage(VolumeFormat format, const std::filesystem::path& file,
                                 const ItkImageHeader& header, const void* voxels, bool compress);

}  // namespace palpate
