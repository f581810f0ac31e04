#include "imaging/dicom_scan.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "imaging/dicom_toolkit.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxFiles = 200'000;
constexpr std::size_t kBatch = 64;  // between two words of progress

Result<std::vector<fs::path>> filesUnder(const fs::path& folder, const Progress& progress) {
  std::vector<fs::path> files;
  std::error_code ec;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, ec);
  for (; !ec && it != fs::recursive_directory_iterator(); it.increment(ec)) {
    std::error_code ignored;
    if (it->is_regular_file(ignored)) files.push_back(it->path());
    if (files.size() > kMaxFiles) {
      return fail(inputRefused("The folder holds more files than Palpate looks through.")
                      .inFile(folder.string())
                      .wants("at most " + std::to_string(kMaxFiles) + " files")
                      .advise("Choose the folder of the one study."));
    }
    if (files.size() % 1024 == 0 && progress.cancelled()) return fail(cancelled());
  }
  if (ec) {
    return fail(machineError("The folder could not be read: " + ec.message() + ".")
                    .inFile(folder.string())
                    .advise("Check that you may read it."));
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool isDirectoryFile(const fs::path& file) {
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return name == "DICOMDIR" && mayBeDicom(file);
}

/// What the archive calls the numbered file.
std::string nameOfMember(const fs::path& file, const std::vector<std::string>& members) {
  const std::string number = file.filename().string();
  return fs::path(members[std::stoul(number)]).filename().string();
}

}  // namespace

Result<DicomScan> scanDicom(const fs::path& path, const Progress& progress) {
  DicomScan scan;
  std::error_code ec;
  fs::path folder = path;
  std::vector<fs::path> paths;
  std::vector<std::string> members;
  if (!fs::is_directory(path, ec)) {
    if (isArchive(path)) {
      auto unpacked = PrivateFolder::make();
      if (!unpacked) return fail(unpacked.error());
      auto names = unpackArchive(path, unpacked->path(), {}, progress);
      if (!names) return fail(names.error());
      members = std::move(*names);
      folder = unpacked->path();
      scan.unpacked.emplace(std::move(*unpacked));
    } else if (isDirectoryFile(path)) {
      // The images that a DICOMDIR lists lie in its own folder; its records may be out of date.
      folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    } else {
      paths.push_back(path);
    }
  }
  if (paths.empty()) {
    auto found = filesUnder(folder, progress);
    if (!found) return fail(found.error());
    paths = std::move(*found);
  }
  prepareDicomToolkit();
  std::vector<std::optional<DicomFile>> headers(paths.size());
  for (std::size_t from = 0; from < paths.size(); from += kBatch) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(from) / static_cast<double>(paths.size()),
             "Looking through files");
    tbb::parallel_for(from, std::min(from + kBatch, paths.size()),
                      [&](std::size_t i) { headers[i] = readDicomHeader(paths[i]); });
  }
  for (auto& header : headers) {
    if (header) {
      if (scan.unpacked) header->name = nameOfMember(header->path, members);
      scan.files.push_back(std::move(*header));
    } else {
      ++scan.skipped;
    }
  }
  return scan;
}

}  // namespace palpate
