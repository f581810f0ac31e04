/// The library: opening cases, importing scans in a child process, the demo.

#include <utility>

#include "app/desktop_child.h"
#include "app/desktop_loop.h"
#include "app/series_rows.h"
#include "core/geometry/units.h"
#include "imaging/segmentation.h"
#include "ui/format.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// A hostile file may ask for anything; a large CT needs about 3 GiB while it is read.
const std::vector<std::string> kLimits{"--limit-memory-mib", "8192", "--limit-seconds", "900"};

}  // namespace

void Desktop::openFirstCase() {
  if (options_.casePath) {
    openCase(*options_.casePath);
    return;
  }
  const auto recent = recent_.list();
  if (!recent.empty()) {
    openCase(recent.front().folder);
  } else if (model_.library.demoAvailable) {
    openDemo();
  }
}

void Desktop::openCase(const fs::path& folder) {
  stopRun();
  jobs_.add("Opening the case", [this, folder](const Progress& progress) {
    auto read = std::make_shared<Result<OpenCase>>(readCase(folder, progress));
    auto view = std::make_shared<CaseView>();
    progress(1.0, "Looking at its values");
    if (*read) *view = viewOf(**read);
    return [this, read, view] {
      if (!*read) {
        refused_ = true;
        refusal_ = read->error();
        if (read->error().kind != ErrorKind::Cancelled) {
          complain(read->error(), "Nothing was changed.");
        }
        return;
      }
      showCase(std::move(**read), std::move(*view));
    };
  });
}

void Desktop::showCase(OpenCase open, CaseView view) {
  simulation_.setScene(nullptr);
  review_.clear();
  sceneInstrument_.clear();
  forgetTrade();
  open_ = std::move(open);
  workspace_->showVolume(open_->volume, view.look);
  model_.openCase = std::move(view.model);
  model_.presetRanges = std::move(view.presetRanges);
  recent_.add(open_->folder);
  model_.library.recent = recent_.list();
  refreshSessions();
  openLabels();
  if (options_.task.empty()) {
    model_.task = open_->labels->empty() ? ui::Task::Segment : ui::Task::Simulate;
  }
}

void Desktop::openDemo() {
  std::error_code error;
  if (options_.demoCase && fs::exists(*options_.demoCase / "case.toml", error)) {
    openCase(*options_.demoCase);
  } else if (options_.demoScan && options_.demoCase) {
    importInto(*options_.demoScan, "", *options_.demoCase, true);
  }
}

fs::path Desktop::newCaseFolder(const fs::path& scan) const {
  // Never the scan's own name: it may be the patient's.
  const fs::path cases = options_.userFolder / "cases";
  std::error_code error;
  for (int i = 1;; ++i) {
    const fs::path folder = cases / ("case-" + std::to_string(i));
    if (!fs::exists(folder, error)) return folder;
  }
  return cases / scan.stem();
}

void Desktop::importScan(const fs::path& path) {
  if (jobs_.busy()) return;
  stopRun();
  jobs_.add("Looking for scans", [this, path](const Progress& progress) {
    std::vector<std::string> arguments{"series",     path.string(), "--json",
                                       "--progress", "--names",     "--thumbnails"};
    arguments.insert(arguments.end(), kLimits.begin(), kLimits.end());
    const auto output = runChild(options_.palpateExecutable, arguments, progress);
    return [this, path, output] {
      if (!output) return complain(output.error(), "Nothing was imported.");
      const auto rows = seriesRows(*output);
      if (rows.size() > 1) {
        model_.library.series = rows;
        model_.library.seriesPath = path;
        model_.task = ui::Task::Library;
      } else {
        // One volume, or none: the import itself says best why it is refused.
        importInto(path, rows.size() == 1 && rows[0].importable ? rows[0].uid : "",
                   newCaseFolder(path), false);
      }
    };
  });
}

void Desktop::importSeries(const fs::path& path, const std::string& uid, const std::string&) {
  if (jobs_.busy()) return;
  model_.library.series.clear();
  importInto(path, uid, newCaseFolder(path), false);
}

void Desktop::importRepaired(bool yes) {
  const fs::path path = std::exchange(model_.library.repairPath, {});
  if (!yes || jobs_.busy()) return;
  importInto(path, model_.library.repairUid, newCaseFolder(path), false,
             model_.library.repairWords);
}

void Desktop::offerRepair(const Error& error, const fs::path& path, const std::string& uid) {
  // "Import it with --repair tilt,spacing to have it resampled": the words after the option.
  const std::string option = "--repair ";
  const std::string advice = error.advice.value_or("");
  const std::size_t at = advice.find(option);
  if (at == std::string::npos) return complain(error, "No case was made.");
  const std::size_t from = at + option.size();
  model_.library.repairWords = advice.substr(from, advice.find(' ', from) - from);
  model_.library.repairPath = path;
  model_.library.repairUid = uid;
  model_.library.repairReason = error.message;
  model_.task = ui::Task::Library;
}

void Desktop::importInto(const fs::path& path, const std::string& uid, const fs::path& folder,
                         bool demo, const std::string& repairs) {
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  fs::permissions(folder.parent_path(), fs::perms::owner_all, error);
  jobs_.add(demo ? "Preparing the demo case" : "Importing the scan",
            [this, path, uid, folder, demo, repairs,
             keep = model_.library.keepNames && !demo](const Progress& progress) {
              std::vector<std::string> arguments{"import",        path.string(), "--out",
                                                 folder.string(), "--json",      "--progress"};
              if (!uid.empty()) arguments.insert(arguments.end(), {"--series", uid});
              if (keep) arguments.emplace_back("--keep-names");
              if (!repairs.empty()) arguments.insert(arguments.end(), {"--repair", repairs});
              arguments.insert(arguments.end(), kLimits.begin(), kLimits.end());
              auto output = runChild(options_.palpateExecutable, arguments, progress);
              if (output && demo) {
                output = runChild(options_.palpateExecutable,
                                  {"segment", folder.string(), "--preset", "ct-bone", "--largest",
                                   "--json", "--progress"},
                                  progress);
              }
              return [this, path, uid, folder, output] {
                if (!output) {
                  if (output.error().kind == ErrorKind::Cancelled) return;
                  refused_ = true;
                  refusal_ = output.error();
                  return offerRepair(output.error(), path, uid);
                }
                openCase(folder);
              };
            });
}

void Desktop::browse(const fs::path& folder) {
  std::error_code error;
  fs::path where = folder;
  if (where.empty() || !fs::is_directory(where, error)) {
    const char* home = std::getenv("HOME");
    where = home != nullptr ? home : "/";
  }
  model_.library.directory = where;
  model_.library.entries = listFolder(where);
}

}  // namespace palpate
