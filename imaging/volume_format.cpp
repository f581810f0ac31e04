#include "imaging/volume_format.h"

#include <zlib.h>

#include <cstring>

namespace palpate {
namespace fs = std::filesystem;
namespace {

bool endsWith(const std::string& text, const char* end) {
  const std::size_t n = std::strlen(end);
  return text.size() >= n && text.compare(text.size() - n, n, end) == 0;
}

bool looksLikeMetaImage(const std::string& head) {
  return head.rfind("ObjectType", 0) == 0 || head.rfind("NDims", 0) == 0 ||
         (head.rfind("Comment", 0) == 0 && head.find("NDims") != std::string::npos);
}

bool looksLikeNifti(const std::string& head) {
  if (head.size() < 348) return false;
  std::int32_t size = 0;
  std::memcpy(&size, head.data(), sizeof size);
  const bool sizeFits = size == 348 || size == 540 || size == 0x5C010000 || size == 0x1C020000;
  return sizeFits && (head.compare(344, 3, "n+1") == 0 || head.compare(344, 3, "ni1") == 0 ||
                      head.compare(4, 3, "n+2") == 0);
}

}  // namespace

std::string firstBytes(const fs::path& file, std::size_t count) {
  std::string bytes(count, '\0');
  gzFile in = gzopen(file.c_str(), "rb");  // reads plain files as they are
  if (in == nullptr) return {};
  const int got = gzread(in, bytes.data(), static_cast<unsigned>(count));
  gzclose(in);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

std::optional<VolumeFormat> volumeFormatByContent(const fs::path& file) {
  const std::string head = firstBytes(file, 1024);
  if (head.rfind("NRRD000", 0) == 0) return VolumeFormat::Nrrd;
  if (looksLikeMetaImage(head)) return VolumeFormat::MetaImage;
  if (looksLikeNifti(head)) return VolumeFormat::Nifti;
  return std::nullopt;
}

Result<VolumeFormat> volumeFormatByName(const fs::path& file) {
  const std::string name = file.filename().string();
  if (endsWith(name, ".nii") || endsWith(name, ".nii.gz")) return VolumeFormat::Nifti;
  if (endsWith(name, ".nrrd") || endsWith(name, ".nhdr")) return VolumeFormat::Nrrd;
  if (endsWith(name, ".mha") || endsWith(name, ".mhd")) return VolumeFormat::MetaImage;
  return fail(usageError("The name does not end in a volume format.")
                  .inFile(file.string())
                  .wants(".nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd")
                  .advise("Give the file one of these endings."));
}

const char* formatName(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::Nifti:
      return "NIfTI";
    case VolumeFormat::Nrrd:
      return "NRRD";
    case VolumeFormat::MetaImage:
      return "MetaImage";
  }
  return "";
}

}  // namespace palpate
