#include "app/desktop_recent.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "core/base/whole_file.h"
#include "core/geometry/units.h"
#include "imaging/case_folder.h"
#include "ui/format.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kKept = 8;
constexpr std::size_t kListed = 500;

bool mayBe(Listed listed, const fs::path& file) {
  static const std::set<std::string> kScans{".dcm",  ".inv3", ".nii", ".gz",  ".nrrd",
                                            ".nhdr", ".mha",  ".mhd", ".zip", ".tar",
                                            ".tgz",  ".xz",   ".ima", ".bz2"};
  static const std::set<std::string> kLabels{".dcm",  ".mha", ".mhd", ".nrrd",
                                             ".nhdr", ".stl", ".ply", ".obj"};
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (listed == Listed::Labels) return kLabels.contains(extension);
  // DICOM files of hospitals often have no extension, or a number.
  return extension.empty() || kScans.contains(extension) || file.filename() == "DICOMDIR";
}

}  // namespace

RecentCases::RecentCases(fs::path userFolder) : file_(std::move(userFolder) / "recent-cases") {
  std::ifstream in(file_);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) folders_.emplace_back(line);
  }
}

std::vector<ui::RecentCase> RecentCases::list() const {
  std::vector<ui::RecentCase> rows;
  for (const fs::path& folder : folders_) {
    const auto info = readCaseInfo(folder);
    if (!info) continue;
    const GridGeometry& g = info->geometry;
    rows.push_back({folder, info->description.empty() ? info->pseudonym : info->description,
                    (info->modality.empty() ? "" : info->modality + " \xc2\xb7 ") +
                        ui::spacingText(millimetres(g.spacing.x()), millimetres(g.spacing.y()),
                                        millimetres(g.spacing.z())) +
                        " \xc2\xb7 " + folder.filename().string()});
  }
  return rows;
}

void RecentCases::add(const fs::path& folder) {
  std::error_code error;
  fs::path whole = fs::absolute(folder, error).lexically_normal();
  if (whole.filename().empty()) whole = whole.parent_path();
  std::erase(folders_, whole);
  folders_.insert(folders_.begin(), whole);
  if (folders_.size() > kKept) folders_.resize(kKept);
  write();
}

void RecentCases::forget(const fs::path& folder) {
  std::erase(folders_, folder);
  write();
}

void RecentCases::write() const {
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  std::string text;
  for (const fs::path& folder : folders_) text += folder.string() + "\n";
  // Losing this list costs a click; it is not worth a message.
  (void)writeWholeFile(file_, text);
}

std::vector<ui::DirectoryRow> listFolder(const fs::path& folder, Listed listed) {
  std::vector<ui::DirectoryRow> rows;
  std::error_code error;
  for (fs::directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
       it != end && rows.size() < kListed; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.empty() || name[0] == '.') continue;
    std::error_code ignored;
    const bool isFolder = it->is_directory(ignored);
    if (isFolder || mayBe(listed, it->path())) rows.push_back({name, isFolder});
  }
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return a.folder != b.folder ? a.folder : a.name < b.name;
  });
  return rows;
}

}  // namespace palpate
