#include "imaging/exchange/exchange_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <optional>

namespace palpate {
namespace fs = std::filesystem;
namespace {

std::optional<ExchangeFormat> byExtension(const fs::path& file) {
  std::string end = file.extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (end == ".dcm") return ExchangeFormat::DicomSeg;
  if (end == ".mha") return ExchangeFormat::MetaImage;
  if (end == ".nrrd") return ExchangeFormat::Nrrd;
  if (end == ".stl") return ExchangeFormat::Stl;
  if (end == ".ply") return ExchangeFormat::Ply;
  if (end == ".obj") return ExchangeFormat::Obj;
  return std::nullopt;
}

bool hasDicomMark(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 4> mark{};
  in.seekg(128);
  in.read(mark.data(), mark.size());
  return in.gcount() == 4 && std::equal(mark.begin(), mark.end(), "DICM");
}

}  // namespace

Result<ExchangeFormat> exportFormat(const fs::path& file) {
  if (const auto format = byExtension(file)) return *format;
  return fail(usageError("The output's name does not say which format to write.")
                  .inField("--out")
                  .butFound(file.extension().empty() ? "no ending" : file.extension().string())
                  .wants(".dcm, .mha, .nrrd, .seg.nrrd, .stl, .ply or .obj")
                  .advise("Give the output one of these endings."));
}

Result<ExchangeFormat> importFormat(const fs::path& file) {
  std::error_code ec;
  if (!fs::is_regular_file(file, ec)) {
    return fail(inputRefused("There is no such file.")
                    .inFile(file.string())
                    .advise("Check the path and its spelling."));
  }
  if (hasDicomMark(file)) return ExchangeFormat::DicomSeg;
  if (const auto format = byExtension(file)) return *format;
  if (file.extension() == ".mhd") return ExchangeFormat::MetaImage;
  if (file.extension() == ".nhdr") return ExchangeFormat::Nrrd;
  return fail(inputRefused("Labels cannot be read from a file of this kind.")
                  .inFile(file.string())
                  .butFound(file.extension().empty() ? "no ending" : file.extension().string())
                  .wants(".dcm, .mha, .mhd, .nrrd, .nhdr, .stl, .ply or .obj")
                  .advise("Export the labels in one of these formats from the program that made "
                          "them."));
}

const char* exchangeFormatName(ExchangeFormat format) {
  switch (format) {
    case ExchangeFormat::DicomSeg:
      return "DICOM SEG";
    case ExchangeFormat::MetaImage:
      return "MetaImage";
    case ExchangeFormat::Nrrd:
      return "NRRD";
    case ExchangeFormat::Stl:
      return "STL";
    case ExchangeFormat::Ply:
      return "PLY";
    case ExchangeFormat::Obj:
      return "OBJ";
  }
  return "";
}

const char* exchangeEnding(ExchangeFormat format) {
  switch (format) {
    case ExchangeFormat::DicomSeg:
      return ".dcm";
    case ExchangeFormat::MetaImage:
      return ".mha";
    case ExchangeFormat::Nrrd:
      return ".seg.nrrd";
    case ExchangeFormat::Stl:
      return ".stl";
    case ExchangeFormat::Ply:
      return ".ply";
    case ExchangeFormat::Obj:
      return ".obj";
  }
  return "";
}

bool isSurface(ExchangeFormat format) {
  return format == ExchangeFormat::Stl || format == ExchangeFormat::Ply ||
         format == ExchangeFormat::Obj;
}

}  // namespace palpate
