#include "imaging/dicom_scan.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>

#include "imaging/dicom_directory.h"
#include "imaging/dicom_toolkit.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxFiles = 200'000;
constexpr std::size_t kBatch = 64;  // between two words of progress
constexpr std::size_t kMaxDirectories = 16;

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

bool isDirectoryFile(const fs::path& file, const std::string& name) {
  return directoryKey(fs::path(name).filename().string()) == "DICOMDIR" && mayBeDicom(file);
}

/// Files, and what they are called from the top of the folder or archive.
struct Files {
  std::vector<fs::path> paths;
  std::vector<std::string> names;
  std::optional<PrivateFolder> unpacked;
};

Result<Files> filesInFolder(const fs::path& folder, const Progress& progress) {
  auto found = filesUnder(folder, progress);
  if (!found) return fail(found.error());
  Files files;
  for (const fs::path& path : *found) {
    files.names.push_back(path.lexically_relative(folder).generic_string());
  }
  files.paths = std::move(*found);
  return files;
}

Result<Files> filesInArchive(const fs::path& archive, const Progress& progress) {
  auto unpacked = PrivateFolder::make();
  if (!unpacked) return fail(unpacked.error());
  const auto members = unpackArchive(archive, unpacked->path(), {}, progress);
  if (!members) return fail(members.error());
  auto files = filesInFolder(unpacked->path(), progress);
  if (!files) return files;
  for (std::string& name : files->names) name = (*members)[std::stoul(name)];
  files->unpacked.emplace(std::move(*unpacked));
  return files;
}

Result<Files> filesOf(const fs::path& path, const Progress& progress) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) return filesInFolder(path, progress);
  if (isArchive(path)) return filesInArchive(path, progress);
  if (isDirectoryFile(path, path.filename().string())) {
    // The images that a DICOMDIR lists lie in its own folder; its records may be out of date.
    return filesInFolder(path.has_parent_path() ? path.parent_path() : fs::path("."), progress);
  }
  return Files{{path}, {path.filename().string()}, {}};
}

/// `files` and `headers` go together; a file without a header is no DICOM object.
std::vector<std::string> warningsOfDirectories(
    const Files& files, const std::vector<std::optional<DicomFile>>& headers) {
  std::vector<std::size_t> directories;
  for (std::size_t i = 0; i < headers.size() && directories.size() < kMaxDirectories; ++i) {
    if (!headers[i] && isDirectoryFile(files.paths[i], files.names[i])) directories.push_back(i);
  }
  if (directories.empty()) return {};
  std::set<std::string> there;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    if (headers[i]) there.insert(directoryKey(files.names[i]));
  }
  std::vector<std::string> warnings;
  for (const std::size_t d : directories) {
    const auto listed = filesOfDirectory(files.paths[d]);
    if (!listed) {
      warnings.emplace_back(
          "The DICOMDIR cannot be read to its end: whether all images are there is not known.");
      continue;
    }
    const std::string top = fs::path(files.names[d]).parent_path().generic_string() + "/";
    const auto missing = std::count_if(listed->begin(), listed->end(), [&](const std::string& f) {
      return !there.contains(directoryKey(top + f));
    });
    if (missing > 0) {
      warnings.push_back("The DICOMDIR lists " + std::to_string(listed->size()) + " files, and " +
                         std::to_string(missing) +
                         " of them are not there or cannot be read: the scan may be incomplete.");
    }
  }
  return warnings;
}

}  // namespace

Result<DicomScan> scanDicom(const fs::path& path, const Progress& progress) {
  auto files = filesOf(path, progress);
  if (!files) return fail(files.error());
  const std::vector<fs::path>& paths = files->paths;
  DicomScan scan;
  prepareDicomToolkit();
  std::vector<std::optional<DicomFile>> headers(paths.size());
  for (std::size_t from = 0; from < paths.size(); from += kBatch) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(from) / static_cast<double>(paths.size()),
             "Looking through files");
    tbb::parallel_for(from, std::min(from + kBatch, paths.size()),
                      [&](std::size_t i) { headers[i] = readDicomHeader(paths[i]); });
  }
  scan.warnings = warningsOfDirectories(*files, headers);
  for (std::size_t i = 0; i < headers.size(); ++i) {
    if (headers[i]) {
      headers[i]->name = fs::path(files->names[i]).filename().string();
      scan.files.push_back(std::move(*headers[i]));
    } else {
      ++scan.skipped;
    }
  }
  if (files->unpacked) scan.unpacked.emplace(std::move(*files->unpacked));
  return scan;
}

}  // namespace palpate
