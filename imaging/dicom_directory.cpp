#include "imaging/dicom_directory.h"

#include <algorithm>

#include "imaging/dicom_stream.h"
#include "imaging/dicom_toolkit.h"

namespace palpate {
namespace {

constexpr std::size_t kMaxRecords = 200'000;
constexpr std::size_t kMaxPath = 1024;  // Eight parts of eight letters in DICOM.

bool isInUse(DcmItem& record) {
  double flag = 0.0;
  return !dicomNumber(record, DCM_RecordInUseFlag, flag) || flag != 0.0;
}

}  // namespace

std::string directoryKey(const std::string& path) {
  std::string key;
  std::string part;
  const auto close = [&] {
    part.resize(std::min(part.size(), part.find(';')));
    while (!part.empty() && (part.back() == '.' || part.back() == ' ')) part.pop_back();
    if (!part.empty() && !key.empty()) key.push_back('/');
    key += part;
    part.clear();
  };
  for (const char c : path) {
    if (c == '/' || c == '\\') {
      close();
    } else {
      part.push_back(c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c);
    }
  }
  close();
  return key;
}

std::optional<std::vector<std::string>> filesOfDirectory(const std::filesystem::path& dicomdir) {
  prepareDicomToolkit();
  DcmFileFormat format;
  if (!parseDicom(format, dicomdir).complete()) return std::nullopt;
  DcmSequenceOfItems* records = nullptr;
  if (format.getDataset()->findAndGetSequence(DCM_DirectoryRecordSequence, records).bad() ||
      records == nullptr) {
    return std::nullopt;
  }
  std::vector<std::string> files;
  // From one to the next: getItem() counts from the first every time.
  DcmObject* next = nullptr;
  while ((next = records->nextInContainer(next)) != nullptr && files.size() < kMaxRecords) {
    auto* record = dynamic_cast<DcmItem*>(next);
    if (record == nullptr || !isInUse(*record)) continue;
    const std::string path = dicomText(*record, DCM_ReferencedFileID);
    if (!path.empty() && path.size() <= kMaxPath) files.push_back(directoryKey(path));
  }
  return files;
}

}  // namespace palpate
