#include "imaging/case_folder.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <bitset>
#include <cerrno>
#include <future>
#include <system_error>

#include "core/base/whole_file.h"
#include "imaging/case_info.h"
#include "imaging/labels_file.h"
#include "imaging/volume_files.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kInfo = "case.toml";
constexpr const char* kVolume = "volume.mha";
constexpr const char* kLabels = "labels.mha";
constexpr const char* kTable = "labels.toml";

// One thousandth of a millimetre: a file saved again by another program (3D Slicer) keeps its
// corners within it, and the geometry of case.toml is the one that counts.

CaseInfo infoOf(const ImportedScan& scan) {
  CaseInfo info;
  info.pseudonym = scan.pseudonym;
  info.description = scan.description;
  info.modality = scan.volume.modality;
  info.sourceFormat = scan.sourceFormat;
  info.patientName = scan.patientName;
  info.patientId = scan.patientId;
  info.warnings = scan.warnings;
  info.repairs = scan.repairs;
  info.lossy = scan.lossy;
  info.geometry = scan.volume.geometry;
  info.voxelType = scan.volume.type;
  info.voxelsSha256 = voxelsSha256(scan.volume);
  return info;
}

/// "a/b/" and "a/b" are the same folder; the name is what comes last.
fs::path withoutSlash(fs::path folder) {
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder;
}

Result<void> refuseForeignFolder(const fs::path& folder) {
  std::error_code ec;
  if (!fs::exists(fs::symlink_status(folder, ec))) return {};
  const bool replaceable = fs::is_directory(folder, ec) &&
                           (fs::is_empty(folder, ec) || fs::is_regular_file(folder / kInfo, ec));
  if (replaceable) return {};
  return fail(inputRefused("The output exists and is not a Palpate case.")
                  .inFile(folder.string())
                  .wants("a new name, an empty folder or a case to replace")
                  .advise("Choose another name for the case."));
}

/// A private folder beside the case, removed unless it was given its name.
class Staging {
 public:
  static Result<Staging> beside(const fs::path& folder) {
    const fs::path parent = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
    std::error_code ec;
    fs::create_directories(parent, ec);
    if (ec) return fail(cannotWrite(parent, ec.value()));
    std::string pattern = (parent / ".palpate-case-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) return fail(cannotWrite(folder, errno));
    return Staging(pattern);
  }
  Staging(Staging&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  Staging& operator=(Staging&&) = delete;
  ~Staging() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const noexcept { return path_; }

  /// Takes the place of `folder`; what was there is then in the staging's place and goes with it.
  Result<void> takeNameOf(const fs::path& folder) {
    std::error_code ec;
    if (!fs::exists(folder, ec)) {
      if (::rename(path_.c_str(), folder.c_str()) != 0) return fail(cannotWrite(folder, errno));
      path_.clear();
      return {};
    }
    if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) {
      return {};
    }
    // A file system without the exchange: two renames, and the old case back if the second fails.
    const fs::path old = path_.string() + "-old";
    if (::rename(folder.c_str(), old.c_str()) != 0) return fail(cannotWrite(folder, errno));
    if (::rename(path_.c_str(), folder.c_str()) != 0) {
      const int failed = errno;
      fs::rename(old, folder, ec);
      return fail(cannotWrite(folder, failed));
    }
    path_ = old;
    return {};
  }

 private:
  explicit Staging(fs::path path) : path_(std::move(path)) {}
  fs::path path_;
};

/// An error of a file in the staging speaks of the case, not of the hidden folder.
template <class T>
Result<void> speakOf(const fs::path& folder, Result<T> result) {
  if (!result) result.error().file = folder.string();
  return result;
}

Result<void> refuseNoCase(const fs::path& folder) {
  std::error_code ec;
  if (fs::is_regular_file(folder / kInfo, ec)) return {};
  const bool there = fs::exists(folder, ec);
  return fail(inputRefused(there ? "This is not a Palpate case." : "There is no such case.")
                  .inFile(folder.string())
                  .wants("a folder with case.toml")
                  .advise("Make a case with: palpate import SCAN --out CASE"));
}

Result<void> refuseNoLabels(const fs::path& folder) {
  if (caseHasLabels(folder)) return {};
  return fail(inputRefused("The case has no labels yet.")
                  .inFile(folder.string())
                  .wants("labels.mha and labels.toml")
                  .advise("Make them with: palpate segment CASE --preset ct-bone"));
}

Error otherVolume(const fs::path& file, const char* field) {
  return inputRefused("The file does not belong to this case, or was changed since the import.")
      .inFile(file.string())
      .inField(field)
      .butFound("another one than case.toml states")
      .advise("Import the scan again.");
}

Result<void> refuseUnnamedLabels(const LabelGrid& grid, const LabelTable& table,
                                 const fs::path& file) {
  std::bitset<256> named;
  named.set(0);
  for (const LabelInfo& info : table) named.set(info.value);
  for (const std::uint8_t label : grid.labels) {
    if (named.test(label)) continue;
    return fail(inputRefused("The label volume holds a value that labels.toml does not name.")
                    .inFile(file.string())
                    .inField("voxels")
                    .butFound("value " + std::to_string(label))
                    .wants("values of labels.toml")
                    .advise("Name the value in labels.toml, or segment again."));
  }
  return {};
}

}  // namespace

Result<CaseInfo> writeNewCase(const fs::path& folder, const ImportedScan& scan) {
  const fs::path name = withoutSlash(folder);
  if (auto allowed = refuseForeignFolder(name); !allowed) return fail(allowed.error());
  auto staging = Staging::beside(name);
  if (!staging) return fail(staging.error());
  auto described = std::async(std::launch::async, [&scan] { return infoOf(scan); });  // hashes
  if (auto ok = speakOf(name, writeVolumeFile(scan.volume, staging->path() / kVolume)); !ok) {
    return fail(ok.error());
  }
  CaseInfo info = described.get();
  const std::string text = caseInfoText(info);
  if (auto ok = speakOf(name, writeWholeFile(staging->path() / kInfo, text)); !ok) {
    return fail(ok.error());
  }
  if (auto ok = speakOf(name, flushToDisk(staging->path())); !ok) return fail(ok.error());
  if (auto ok = staging->takeNameOf(name); !ok) return fail(ok.error());
  const fs::path parent = name.has_parent_path() ? name.parent_path() : fs::path(".");
  if (auto ok = flushToDisk(parent); !ok) return fail(ok.error());
  return info;
}

Result<CaseInfo> readCaseInfo(const fs::path& folder) {
  if (auto there = refuseNoCase(folder); !there) return fail(there.error());
  return parseCaseInfo(folder / kInfo);
}

Result<Volume> readCaseVolume(const fs::path& folder) {
  const auto info = readCaseInfo(folder);
  if (!info) return fail(info.error());
  const fs::path file = folder / kVolume;
  auto volume = readVolumeFile(file);
  if (!volume) return volume;
  if (!volume->geometry.sameAs(info->geometry)) {
    return fail(otherVolume(file, "geometry"));
  }
  if (voxelsSha256(*volume) != info->voxelsSha256) return fail(otherVolume(file, "voxels"));
  volume->geometry = info->geometry;
  volume->modality = info->modality;
  return volume;
}

bool caseHasLabels(const fs::path& folder) {
  std::error_code ec;
  return fs::is_regular_file(folder / kLabels, ec) && fs::is_regular_file(folder / kTable, ec);
}

Result<LabelTable> readCaseLabelTable(const fs::path& folder) {
  if (auto there = refuseNoCase(folder); !there) return fail(there.error());
  if (auto labels = refuseNoLabels(folder); !labels) return fail(labels.error());
  return readLabelTable(folder / kTable);
}

Result<LabelState> readCaseLabelState(const fs::path& folder) {
  const auto info = readCaseInfo(folder);
  if (!info) return fail(info.error());
  auto table = readCaseLabelTable(folder);
  if (!table) return fail(table.error());
  const fs::path file = folder / kLabels;
  auto grid = readLabelFile(file);
  if (!grid) return fail(grid.error());
  if (!grid->geometry.sameAs(info->geometry)) {
    return fail(otherVolume(file, "geometry").advise("Segment again."));
  }
  if (auto named = refuseUnnamedLabels(*grid, *table, file); !named) return fail(named.error());
  grid->geometry = info->geometry;
  return LabelState{std::move(*grid), std::move(*table)};
}

Result<LabelGrid> readCaseLabels(const fs::path& folder) {
  auto state = readCaseLabelState(folder);
  if (!state) return fail(state.error());
  return std::move(state->labels);
}

Result<void> writeCaseLabels(const fs::path& folder, const LabelGrid& labels,
                             const LabelTable& table) {
  const auto info = readCaseInfo(folder);
  if (!info) return fail(info.error());
  if (auto fits = checkLabelTable(table); !fits) return fits;
  if (auto named = refuseUnnamedLabels(labels, table, folder / kLabels); !named) return named;
  if (!labels.geometry.sameAs(info->geometry)) {
    return fail(otherVolume(folder / kLabels, "geometry").advise("Segment the case's own volume."));
  }
  // Both are complete beside their names before either gets its name.
  auto staging = Staging::beside(folder / kLabels);
  if (!staging) return fail(staging.error());
  const std::string text = labelTableText(table);
  if (auto ok = speakOf(folder, writeLabelFile(labels, staging->path() / kLabels)); !ok) return ok;
  if (auto ok = speakOf(folder, writeWholeFile(staging->path() / kTable, text)); !ok) return ok;
  for (const char* file : {kTable, kLabels}) {
    if (::rename((staging->path() / file).c_str(), (folder / file).c_str()) != 0) {
      return fail(cannotWrite(folder, errno));
    }
  }
  return flushToDisk(folder);
}

}  // namespace palpate
