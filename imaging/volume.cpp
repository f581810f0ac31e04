#include "imaging/volume.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/hexadecimal.h"

namespace palpate {
namespace {

// The hash is of little-endian bytes; every machine Debian 12 is packaged for here is one.
static_assert(std::endian::native == std::endian::little);

template <class T>
std::pair<double, double> finiteRange(const std::vector<T>& values) {
  T low = std::numeric_limits<T>::max();
  T high = std::numeric_limits<T>::lowest();
  for (const T v : values) {
    // Comparisons with NaN are false: such voxels count for nothing.
    if (v < low) low = v;
    if (v > high) high = v;
  }
  if (low > high) return {0.0, 0.0};
  return {static_cast<double>(low), static_cast<double>(high)};
}

bool isInt16(float v) noexcept {
  return v >= -32768.0F && v <= 32767.0F && v == std::trunc(v);
}

template <class T>
void flipSlices(std::vector<T>& values, const std::array<std::int32_t, 3>& dims) {
  const std::size_t slice = static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]);
  const auto slices = static_cast<std::size_t>(dims[2]);
  for (std::size_t low = 0, high = slices - 1; low < high; ++low, --high) {
    std::swap_ranges(values.begin() + static_cast<std::ptrdiff_t>(low * slice),
                     values.begin() + static_cast<std::ptrdiff_t>((low + 1) * slice),
                     values.begin() + static_cast<std::ptrdiff_t>(high * slice));
  }
}

}  // namespace

std::pair<double, double> valueRange(const Volume& volume) {
  return volume.type == VoxelType::Int16 ? finiteRange(volume.int16) : finiteRange(volume.float32);
}

std::string voxelsSha256(const Volume& volume) {
  const void* bytes = volume.type == VoxelType::Int16
                          ? static_cast<const void*>(volume.int16.data())
                          : static_cast<const void*>(volume.float32.data());
  const std::size_t count =
      volume.size() * (volume.type == VoxelType::Int16 ? sizeof(std::int16_t) : sizeof(float));
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes, count, digest.data(), &length, EVP_sha256(), nullptr) != 1) return {};
  return hexadecimal({digest.data(), length});
}

void narrowToInt16IfExact(Volume& volume) {
  if (volume.type != VoxelType::Float32) return;
  if (!std::all_of(volume.float32.begin(), volume.float32.end(), isInt16)) return;
  volume.int16.resize(volume.float32.size());
  std::transform(volume.float32.begin(), volume.float32.end(), volume.int16.begin(),
                 [](float v) { return static_cast<std::int16_t>(v); });
  volume.float32 = {};
  volume.type = VoxelType::Int16;
}

void flipSliceOrder(Volume& volume) {
  if (volume.type == VoxelType::Int16) {
    flipSlices(volume.int16, volume.geometry.dims);
  } else {
    flipSlices(volume.float32, volume.geometry.dims);
  }
}

void flipSliceOrder(LabelGrid& labels) {
  flipSlices(labels.labels, labels.geometry.dims);
}

}  // namespace palpate
