/// Labels of the open case to files of other programs, and theirs into the case.

#include <cstdlib>

#include "app/desktop_loop.h"
#include "core/base/counted.h"
#include "imaging/exchange/label_exchange.h"
#include "ui/format.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path homeFolder() {
  const char* home = std::getenv("HOME");
  return home != nullptr ? home : "/";
}

/// "head.seg.nrrd, NRRD: bone, mandible; 432,952 voxels."
std::string describe(const fs::path& file, const ExportReport& report) {
  std::string names;
  std::uint64_t voxels = 0;
  for (const ExportedLabel& label : report.labels) {
    names += (names.empty() ? "" : ", ") + label.name;
    voxels += label.voxels;
  }
  const std::string amount = isSurface(report.format)
                                 ? ui::grouped(report.triangles) + " triangles"
                                 : ui::grouped(voxels) + (voxels == 1 ? " voxel" : " voxels");
  return file.filename().string() + ", " + exchangeFormatName(report.format) + ": " + names + "; " +
         amount + ".";
}

}  // namespace

/// "~" is the home; a name alone goes where the last file went.
fs::path Desktop::resolved(const fs::path& typed) const {
  const std::string text = typed.string();
  if (text == "~") return homeFolder();
  if (text.rfind("~/", 0) == 0) return homeFolder() / text.substr(2);
  return typed.is_absolute() ? typed : model_.segment.exchange.folder / typed;
}

void Desktop::exportLabelsNow(const ui::ExportWish& wish) {
  if (!open_ || open_->labels->empty()) return;
  if (labelWorker_.busy()) return afterSteps_.push_back([this, wish] { exportLabelsNow(wish); });
  ExportRequest request{open_->folder, resolved(wish.file), wish.labels, wish.overwrite,
                        PALPATE_VERSION};
  model_.segment.exchange.asks.reset();
  model_.segment.exchange.folder = request.file.parent_path();
  jobs_.add("Exporting the labels", [this, request, info = open_->info,
                                     labels = open_->labels](const Progress& progress) {
    std::error_code error;
    const bool there = !request.overwrite && fs::exists(fs::symlink_status(request.file, error));
    const auto done = std::make_shared<const Result<ExportReport>>(
        exportLabels(request, info, *labels->grid, labels->table, progress));
    return [this, request, there, done] {
      if (!*done && there && done->error().kind == ErrorKind::InputRefused) {
        model_.segment.exchange.asks = ui::ExportWish{request.file, request.labels, true};
        return;
      }
      if (!*done) return complain(done->error(), "Nothing was written.");
      say({ui::MessageModel::Kind::Information, "The labels are exported.",
           describe(request.file, **done), "In " + request.file.parent_path().string()});
      for (const std::string& warning : (*done)->warnings) {
        say({ui::MessageModel::Kind::Warning, warning, "", ""});
      }
    };
  });
}

void Desktop::joinLabelsNow(const fs::path& file, const std::string& only) {
  if (!open_) return;
  leaveSegment();
  const fs::path path = resolved(file);
  model_.segment.exchange.folder = path.parent_path();
  labelWorker_.join(path, only);
}

void Desktop::browseLabels(const fs::path& folder) {
  std::error_code error;
  const fs::path wanted = folder.empty() ? model_.segment.exchange.folder : resolved(folder);
  const fs::path where = fs::is_directory(wanted, error) ? wanted : homeFolder();
  model_.segment.exchange.folder = where;
  model_.segment.exchange.entries = listFolder(where, Listed::Labels);
}

}  // namespace palpate
