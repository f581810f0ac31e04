#include "imaging/stored_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace palpate {
namespace fs = std::filesystem;
namespace {

std::uint64_t sizeOf(const fs::path& file) {
  std::error_code ec;
  const auto size = fs::file_size(file, ec);
  return ec ? 0 : size;
}

/// Bytes that a zlib or gzip stream inflates to; empty when it is damaged or has no proper end.
std::optional<std::uint64_t> inflatedSize(const fs::path& file, std::uint64_t offset) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 32) != Z_OK) return std::nullopt;  // 32: zlib or gzip, by itself
  const std::unique_ptr<z_stream, int (*)(z_stream*)> release(&stream, inflateEnd);
  std::vector<char> from(1U << 18U);
  std::vector<char> to(1U << 20U);
  std::uint64_t total = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    if (stream.avail_in == 0) {
      in.read(from.data(), static_cast<std::streamsize>(from.size()));
      stream.next_in = reinterpret_cast<Bytef*>(from.data());
      stream.avail_in = static_cast<uInt>(in.gcount());
      if (stream.avail_in == 0) return std::nullopt;
    }
    stream.next_out = reinterpret_cast<Bytef*>(to.data());
    stream.avail_out = static_cast<uInt>(to.size());
    status = inflate(&stream, Z_NO_FLUSH);
    total += to.size() - stream.avail_out;
  }
  if (status != Z_STREAM_END) return std::nullopt;
  return total;
}

bool niftiIsWhole(const fs::path& file, std::uint64_t voxels) {
  const std::string head = firstBytes(file, 348);
  if (head.size() < 348) return false;
  // bitpix at 72, vox_offset at 108; swapped when the header's size reads wrongly.
  const bool swapped = head[0] != 92;  // 348 = 0x15C, lowest byte first
  std::array<char, 2> bits{head[72], head[73]};
  std::array<char, 4> offset{head[108], head[109], head[110], head[111]};
  if (swapped) {
    std::swap(bits[0], bits[1]);
    std::swap(offset[0], offset[3]);
    std::swap(offset[1], offset[2]);
  }
  std::int16_t bitpix = 0;
  float voxOffset = 0.0F;
  std::memcpy(&bitpix, bits.data(), sizeof bitpix);
  std::memcpy(&voxOffset, offset.data(), sizeof voxOffset);
  if (bitpix <= 0 || !std::isfinite(voxOffset) || voxOffset < 0.0F) return false;
  const std::uint64_t needed =
      static_cast<std::uint64_t>(voxOffset) + voxels * static_cast<std::uint64_t>(bitpix) / 8;
  const bool gzipped = [&] {
    std::ifstream in(file, std::ios::binary);
    return in.get() == 0x1F && in.get() == 0x8B;
  }();
  if (!gzipped) return sizeOf(file) >= needed;
  const auto inflated = inflatedSize(file, 0);
  return inflated && *inflated >= needed;
}

struct MetaImageData {
  fs::path file;
  std::uint64_t offset = 0;
  bool compressed = false;
};

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  const std::size_t to = text.find_last_not_of(" \t\r");
  return from == std::string::npos ? std::string() : text.substr(from, to - from + 1);
}

/// Where the voxels lie, from the text header; empty for lists of files and headers without an end.
std::optional<MetaImageData> locate(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  MetaImageData data;
  std::string line;
  for (int n = 0; n < 10'000 && std::getline(in, line); ++n) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string key = trimmed(line.substr(0, equals));
    const std::string value = trimmed(line.substr(equals + 1));
    if (key == "CompressedData")
      data.compressed = value == "True" || value == "true" || value == "1";
    if (key == "HeaderSize") data.offset = static_cast<std::uint64_t>(std::atoll(value.c_str()));
    if (key != "ElementDataFile") continue;
    if (value == "LOCAL" || value == "Local" || value == "local") {
      data.file = file;
      data.offset = static_cast<std::uint64_t>(in.tellg());
      return data;
    }
    if (value.rfind("LIST", 0) == 0 || value.find('%') != std::string::npos) return std::nullopt;
    data.file = file.parent_path() / value;
    return data;
  }
  return std::nullopt;
}

bool metaImageIsWhole(const fs::path& file, std::uint64_t bytes) {
  const auto data = locate(file);
  if (!data) return false;
  if (data->compressed) {
    const auto inflated = inflatedSize(data->file, data->offset);
    return inflated && *inflated >= bytes;
  }
  const std::uint64_t size = sizeOf(data->file);
  return size >= bytes && size - bytes >= data->offset;
}

}  // namespace

bool holdsAllVoxels(VolumeFormat format, const fs::path& file, std::uint64_t voxels,
                    std::uint64_t bytesPerVoxel) {
  switch (format) {
    case VolumeFormat::Nifti:
      return niftiIsWhole(file, voxels);
    case VolumeFormat::MetaImage:
      return metaImageIsWhole(file, voxels * bytesPerVoxel);
    case VolumeFormat::Nrrd:
      return true;
  }
  return false;
}

bool endsWithBytes(const fs::path& file, std::span<const char> bytes) {
  const std::uint64_t size = sizeOf(file);
  if (size < bytes.size()) return false;
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(size - bytes.size()));
  std::vector<char> block(1U << 20U);
  while (!bytes.empty()) {
    const std::size_t count = std::min(block.size(), bytes.size());
    in.read(block.data(), static_cast<std::streamsize>(count));
    if (static_cast<std::size_t>(in.gcount()) != count ||
        std::memcmp(block.data(), bytes.data(), count) != 0) {
      return false;
    }
    bytes = bytes.subspan(count);
  }
  return true;
}

}  // namespace palpate
