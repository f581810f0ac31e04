#include "imaging/volume_files.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <future>
#include <type_traits>
#include <utility>

#include "core/base/whole_file.h"
#include "imaging/itk_image_file.h"
#include "imaging/nifti_header.h"
#include "imaging/rigid_geometry.h"
#include "imaging/stored_bytes.h"
#include "imaging/volume_format.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

// Deflate shrinks at most 1032 times (zlib's documentation), so a file cannot hold more than this.
constexpr std::uint64_t kMaxInflation = 1032;

struct OpenedImage {
  VolumeFormat format{};
  ItkImageHeader header;
  GridGeometry geometry;
  bool flipSlices = false;
};

Error damaged(const fs::path& file, VolumeFormat format, const char* what) {
  return inputRefused(std::string("The ") + formatName(format) + " file " + what + ".")
      .inFile(file.string())
      .advise("It is damaged or cut short: copy it again from where it came.");
}
Result<VolumeFormat> recognised(const fs::path& file) {
  std::error_code ec;
  if (!fs::exists(file, ec)) {
    return fail(inputRefused("There is no such file.")
                    .inFile(file.string())
                    .advise("Check the path and its spelling."));
  }
  const auto format = volumeFormatByContent(file);
  if (!format) {
    return fail(inputRefused("The file is not a NIfTI, NRRD or MetaImage volume.")
                    .inFile(file.string())
                    .wants("a .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd file")
                    .advise("Choose the scan itself; a file with the right ending may still be "
                            "damaged."));
  }
  const auto named = volumeFormatByName(file);
  if (!named || *named != *format) {
    return fail(inputRefused(std::string("The content is ") + formatName(*format) +
                             ", but the name does not say so.")
                    .inFile(file.string())
                    .advise("Rename the file with the ending of its format."));
  }
  return *format;
}

Result<void> refuseOtherShapes(const ItkImageHeader& header, const fs::path& file) {
  if (header.volumes != 1) {
    return fail(inputRefused("The file holds several volumes (a fourth axis).")
                    .inFile(file.string())
                    .inField("dimensions")
                    .butFound(std::to_string(header.volumes) + " volumes")
                    .wants("one volume")
                    .advise("Export the one volume to feel, and import that."));
  }
  if (header.components != 1) {
    return fail(inputRefused("The voxels are colours or vectors, not single values.")
                    .inFile(file.string())
                    .inField("components")
                    .butFound(std::to_string(header.components) + " values per voxel")
                    .wants("1 value per voxel")
                    .advise("Export a grey-value volume."));
  }
  if (header.type == StoredType::Other) {
    return fail(inputRefused("The voxels have a type that Palpate does not read.")
                    .inFile(file.string())
                    .inField("voxel type")
                    .wants("integers of 8 to 64 bits, or floats of 32 or 64")
                    .advise("Save the volume with 16-bit integers or 32-bit floats."));
  }
  return {};
}

Result<std::array<std::int32_t, 3>> boundedDims(const ItkImageHeader& header, const fs::path& file,
                                                VolumeFormat format) {
  std::array<std::int32_t, 3> dims{1, 1, 1};
  std::uint64_t voxels = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::uint64_t n = header.dims[d];
    if (n == 0 || n > kMaxVoxels || voxels * n > kMaxVoxels) {
      return fail(damaged(file, format, "states an impossible size")
                      .inField("dimensions")
                      .butFound(std::to_string(n) + " voxels along one axis")
                      .wants("1 to 2^31 voxels in all"));
    }
    dims[d] = static_cast<std::int32_t>(n);
    voxels *= n;
  }
  const std::string name = file.filename().string();
  const bool inOneFile = !name.ends_with(".nhdr") && !name.ends_with(".mhd");
  const std::uint64_t needed = voxels * header.bytesPerValue;
  if (inOneFile && needed > fs::file_size(file) * kMaxInflation) {
    return fail(damaged(file, format, "is too short for the size it states")
                    .butFound(std::to_string(fs::file_size(file)) + " bytes")
                    .wants(std::to_string(needed) + " bytes of voxels"));
  }
  return dims;
}

FoundAffine affineFromItk(const ItkImageHeader& header) {
  FoundAffine a;
  a.axes_mm = Eigen::Map<const Eigen::Matrix3d>(header.direction.data());
  for (Eigen::Index d = 0; d < 3; ++d) {
    a.axes_mm.col(d) *= header.spacing_mm[static_cast<std::size_t>(d)];
    a.origin_mm[d] = header.origin_mm[static_cast<std::size_t>(d)];
  }
  return a;
}

void warnOfNoPatientSpace(std::vector<std::string>* warnings) {
  if (warnings == nullptr) return;
  warnings->push_back(
      "The file does not say how the voxels lie in the patient: the letters R, L, A, P, H and F "
      "are "
      "a guess.");
}

Result<OpenedImage> open(const fs::path& file, std::vector<std::string>* warnings) {
  const auto format = recognised(file);
  if (!format) return fail(format.error());
  FoundAffine affine;
  const char* field = "direction";
  bool inPatient = true;
  if (*format == VolumeFormat::Nifti) {
    const auto placement = readNiftiPlacement(file);
    if (!placement) return fail(placement.error());
    affine = placement->affine;
    field = placement->field;
    inPatient = placement->inPatient;
  }
  OpenedImage image;
  image.format = *format;
  const auto header = readItkHeader(*format, file);
  if (!header) return fail(damaged(file, *format, "has a header that cannot be read"));
  image.header = *header;
  if (auto shape = refuseOtherShapes(*header, file); !shape) return fail(shape.error());
  const auto dims = boundedDims(*header, file, *format);
  if (!dims) return fail(dims.error());
  if (*format != VolumeFormat::Nifti) {
    affine = affineFromItk(*header);
    inPatient = header->saysPatientSpace;
  }
  if (!inPatient) warnOfNoPatientSpace(warnings);
  auto geometry = rigidGeometry(*dims, affine, file, field, image.flipSlices);
  if (!geometry) return fail(geometry.error());
  image.geometry = *geometry;
  return image;
}

Result<std::vector<char>> readBytes(const OpenedImage& image, const fs::path& file) {
  auto whole = std::async(std::launch::async, [&image, &file] {
    return holdsAllVoxels(image.format, file, image.geometry.voxelCount(),
                          image.header.bytesPerValue);
  });
  auto bytes = readItkVoxels(image.format, file);
  if (!whole.get() || bytes.size() != image.geometry.voxelCount() * image.header.bytesPerValue) {
    return fail(damaged(file, image.format, "ends before its last voxel"));
  }
  return bytes;
}

/// Calls `visit(values, count)` with the stored type.
template <class Visit>
void withStoredType(StoredType type, const std::vector<char>& bytes, Visit&& visit) {
  const auto as = [&](auto zero) {
    using T = decltype(zero);
    visit(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T));
  };
  switch (type) {
    case StoredType::UInt8:
      return as(std::uint8_t{});
    case StoredType::Int8:
      return as(std::int8_t{});
    case StoredType::UInt16:
      return as(std::uint16_t{});
    case StoredType::Int16:
      return as(std::int16_t{});
    case StoredType::UInt32:
      return as(std::uint32_t{});
    case StoredType::Int32:
      return as(std::int32_t{});
    case StoredType::UInt64:
      return as(std::uint64_t{});
    case StoredType::Int64:
      return as(std::int64_t{});
    case StoredType::Float32:
      return as(0.0F);
    case StoredType::Float64:
      return as(0.0);
    case StoredType::Other:
      return;
  }
}

template <class T>
bool fitsInt16(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return value >= T(-32768) && value <= T(32767) && value == std::trunc(value);
  } else {
    return std::in_range<std::int16_t>(value);
  }
}

template <class T>
void takeValues(const T* values, std::size_t count, Volume& volume) {
  if (std::all_of(values, values + count, [](T v) { return fitsInt16(v); })) {
    volume.type = VoxelType::Int16;
    volume.int16.resize(count);
    std::transform(values, values + count, volume.int16.begin(),
                   [](T v) { return static_cast<std::int16_t>(v); });
  } else {
    volume.type = VoxelType::Float32;
    volume.float32.resize(count);
    std::transform(values, values + count, volume.float32.begin(),
                   [](T v) { return static_cast<float>(v); });
  }
}

Result<void> refuseNotNumbers(const Volume& volume, const fs::path& file) {
  const auto bad = std::find_if_not(volume.float32.begin(), volume.float32.end(),
                                    [](float v) { return std::isfinite(v); });
  if (bad == volume.float32.end()) return {};
  const auto index = static_cast<std::size_t>(bad - volume.float32.begin());
  const auto nx = static_cast<std::size_t>(volume.geometry.dims[0]);
  const auto ny = static_cast<std::size_t>(volume.geometry.dims[1]);
  return fail(inputRefused("Some voxels are not numbers (NaN or infinity).")
                  .inFile(file.string())
                  .inField("voxel " + std::to_string(index % nx) + "," +
                           std::to_string(index / nx % ny) + "," + std::to_string(index / nx / ny))
                  .butFound(std::isnan(*bad) ? "NaN" : "infinity")
                  .wants("finite values")
                  .advise("Replace such voxels by the background value in the program that made "
                          "the file."));
}

/// ITK's writers do not all notice a full disk: what was written is looked at before it gets its
/// name. Plain voxels are the last bytes of a file, so that no second volume is needed in memory.
bool holds(const fs::path& file, VolumeFormat format, bool plain, const void* voxels,
           std::size_t bytes) {
  if (plain) return endsWithBytes(file, {static_cast<const char*>(voxels), bytes});
  const auto back = readItkVoxels(format, file);
  return back.size() == bytes && std::memcmp(back.data(), voxels, bytes) == 0;
}

Result<void> writeImage(const GridGeometry& geometry, StoredType type, std::size_t bytesPerValue,
                        const void* voxels, bool compress, const fs::path& file,
                        const HeaderTexts& texts = {}) {
  const auto format = volumeFormatByName(file);
  if (!format) return fail(format.error());
  if (file.extension() == ".mhd" || file.extension() == ".nhdr") {
    return fail(usageError("Volumes are written as one file, so that they appear whole.")
                    .inFile(file.string())
                    .wants(".nii, .nii.gz, .nrrd or .mha")
                    .advise("Give the file one of these endings."));
  }
  auto whole = WholeFile::beside(file);
  if (!whole) return fail(whole.error());
  ItkImageHeader header;
  header.type = type;
  if (*format == VolumeFormat::Nrrd) header.texts = texts;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const auto d = static_cast<std::size_t>(a);
    header.dims[d] = static_cast<std::uint64_t>(geometry.dims[d]);
    header.spacing_mm[d] = geometry.spacing[a] * 1e3;
    header.origin_mm[d] = geometry.X_PV.translation()[a] * 1e3;
    for (std::size_t r = 0; r < 3; ++r) {
      header.direction[3 * d + r] = geometry.X_PV.linear()(static_cast<Eigen::Index>(r), a);
    }
  }
  errno = 0;
  if (!writeItkImage(*format, whole->hiddenName(), header, voxels, compress)) {
    return fail(cannotWrite(file, errno != 0 ? errno : EIO));
  }
  const bool plain = !compress && file.extension() != ".gz";
  const std::size_t bytes = geometry.voxelCount() * bytesPerValue;
  if (!holds(whole->hiddenName(), *format, plain, voxels, bytes)) {
    return fail(cannotWrite(file, ENOSPC));
  }
  return whole->commit();
}

}  // namespace

Result<GridGeometry> readVolumeGeometry(const fs::path& file) {
  auto image = open(file, nullptr);
  if (!image) return fail(image.error());
  return image->geometry;
}

Result<Volume> readVolumeFile(const fs::path& file, std::vector<std::string>* warnings) {
  auto image = open(file, warnings);
  if (!image) return fail(image.error());
  auto bytes = readBytes(*image, file);
  if (!bytes) return fail(bytes.error());
  Volume volume;
  volume.geometry = image->geometry;
  withStoredType(image->header.type, *bytes,
                 [&volume](const auto* v, std::size_t n) { takeValues(v, n, volume); });
  if (auto numbers = refuseNotNumbers(volume, file); !numbers) return fail(numbers.error());
  if (image->flipSlices) flipSliceOrder(volume);
  return volume;
}

Result<void> writeVolumeFile(const Volume& volume, const fs::path& file) {
  return volume.type == VoxelType::Int16
             ? writeImage(volume.geometry, StoredType::Int16, 2, volume.int16.data(), false, file)
             : writeImage(volume.geometry, StoredType::Float32, 4, volume.float32.data(), false,
                          file);
}

Result<LabelGrid> readLabelFile(const fs::path& file) {
  auto image = open(file, nullptr);
  if (!image) return fail(image.error());
  auto bytes = readBytes(*image, file);
  if (!bytes) return fail(bytes.error());
  LabelGrid grid;
  grid.geometry = image->geometry;
  grid.labels.resize(grid.geometry.voxelCount());
  std::optional<double> offending;
  withStoredType(image->header.type, *bytes, [&](const auto* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = static_cast<double>(values[i]);
      if (!(value >= 0.0 && value <= 255.0 && value == std::trunc(value))) {
        offending = value;
        return;
      }
      grid.labels[i] = static_cast<std::uint8_t>(values[i]);
    }
  });
  if (offending) {
    char found[32];
    std::snprintf(found, sizeof found, "%.9g", *offending);
    return fail(inputRefused("The file holds values that are not labels.")
                    .inFile(file.string())
                    .inField("voxels")
                    .butFound(found)
                    .wants("whole numbers from 0 to 255")
                    .advise("Choose a label volume, or number its labels from 0 to 255."));
  }
  if (image->flipSlices) flipSliceOrder(grid);
  return grid;
}

Result<void> writeLabelFile(const LabelGrid& labels, const fs::path& file,
                            const HeaderTexts& texts) {
  return writeImage(labels.geometry, StoredType::UInt8, 1, labels.labels.data(), true, file, texts);
}

}  // namespace palpate
