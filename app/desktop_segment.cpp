/// Labels of the open case: previewed, made, edited, undone; then drawn, saved and made ready to
/// feel.

#include <algorithm>

#include "app/desktop_loop.h"
#include "imaging/segment/case_recipe.h"
#include "ui/format.h"

namespace palpate {
namespace {

constexpr std::size_t kUndoSteps = 30;

/// Labels, table and recipe on disk; a table without labels removes the files.
Result<void> writeLabels(const std::filesystem::path& folder, const CountedLabels& labels,
                         const CaseRecipe& recipe) {
  if (!labels.empty()) {
    if (auto written = writeCaseLabels(folder, *labels.grid, labels.table); !written) {
      return written;
    }
    return writeCaseRecipe(folder, recipe);
  }
  std::error_code error;
  for (const char* file : {"labels.mha", "labels.toml", kCaseRecipe}) {
    std::filesystem::remove(folder / file, error);
    if (error) {
      return fail(machineError("The labels could not be removed.").inFile(folder.string()));
    }
  }
  return {};
}

/// What happened and what to do, without the names that a recipe has for it.
Error plain(Error error) {
  error.file.reset();
  error.field.reset();
  error.found.reset();
  error.expected.reset();
  return error;
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::string describe(const LabelStep& step) {
  return toolTitle(step.tool) + ", " + step.label;
}

/// "Preview: 1 203 voxels fewer": what the label gains or loses.
std::string compared(std::uint64_t was, std::uint64_t is) {
  if (was == is) return "Preview: no voxel more or fewer";
  const std::uint64_t change = was > is ? was - is : is - was;
  const char* how = was == 0 ? "" : is > was ? " more" : " fewer";
  return "Preview: " + ui::grouped(change) + (change == 1 ? " voxel" : " voxels") + how;
}

}  // namespace

int Desktop::meshStep() const {
  // Software rendering is bound by vertices: half the resolution is a quarter of them.
  return window_->softwareRendering() && open_->volume->size() > 12'000'000 ? 2 : 1;
}

void Desktop::openLabels() {
  undo_.clear();
  redo_.clear();
  afterSteps_.clear();
  surfaces_.clear();
  unsaved_ = false;
  recipe_ = readCaseRecipe(open_->folder);
  if (!open_->labels->empty() && recipe_.steps.empty()) recipe_.whole = false;
  labelWorker_.open(open_->volume, open_->labels, meshStep());
  workspace_->clearSurfaces();
  workspace_->segment() = {};
  model_.segment.previewShown = false;
  model_.segment.previewText.clear();
  takeLabels(open_->labels);
  if (!open_->labels->empty()) meshLabels();
}

void Desktop::takeLabels(const SharedLabels& labels) {
  open_->labels = labels;
  model_.segment.labels = rowsOf(*labels);
  model_.segment.previewShown = false;
  describeUndo();
  workspace_->showLabels(labels->empty() ? nullptr : labels->grid);
  workspace_->showRows(model_.segment.labels);
  workspace_->keepSurfaces(model_.segment.labels);
  std::erase_if(surfaces_, [this](const auto& entry) {
    return std::none_of(model_.segment.labels.begin(), model_.segment.labels.end(),
                        [&entry](const ui::LabelRow& row) { return row.value == entry.first; });
  });
  if (!labels->empty()) return prepare();
  if (simulation_.running()) stopRun();
  simulation_.setScene(nullptr);
  model_.simulate.notReady = "Nothing is labelled yet, so there is nothing to feel.";
}

std::vector<ui::LabelRow> Desktop::rowsOf(const CountedLabels& labels) const {
  std::vector<ui::LabelRow> rows = labelRows(labels);
  for (ui::LabelRow& row : rows) {
    for (const ui::LabelRow& shown : model_.segment.labels) {
      if (shown.value == row.value) row.visible = shown.visible;
    }
  }
  return rows;
}

void Desktop::describeUndo() {
  model_.segment.undo = undo_.empty() ? std::string() : undo_.back().what;
  model_.segment.redo = redo_.empty() ? std::string() : redo_.back().what;
}

void Desktop::pollLabels() {
  while (auto outcome = labelWorker_.poll()) takeOutcome(*outcome);
  while (!afterSteps_.empty() && !labelWorker_.busy()) {
    const auto wish = std::move(afterSteps_.front());
    afterSteps_.pop_front();
    wish();
  }
  model_.segment.previewing = labelWorker_.previewing();
}

void Desktop::takeOutcome(LabelWorker::Outcome& outcome) {
  using Kind = LabelWorker::Kind;
  if (!open_) return;
  if (outcome.kind == Kind::Surfaces) return takeSurfaces(outcome);
  if (outcome.kind == Kind::Preview) return takePreview(outcome);
  if (!outcome.labels) {
    restoring_ = Restoring::No;
    dropPreview();
    const bool file = outcome.kind == Kind::Joined;
    return complain(file ? outcome.error : plain(outcome.error), "The labels are as they were.");
  }
  const UndoEntry past{outcome.before, outcome.before->table, "", recipe_};
  if (outcome.kind != Kind::Restored) {
    undo_.push_back(past);
    undo_.back().what =
        outcome.kind == Kind::Step ? describe(outcome.step) : std::string("Labels from a file");
    if (undo_.size() > kUndoSteps) undo_.erase(undo_.begin());
    redo_.clear();
    workspace_->segment().forgetPicks();  // the next stroke may be under way
    if (outcome.kind == Kind::Step) {
      recipe_.steps.push_back(outcome.step);
    } else {
      recipe_.whole = false;  // no step makes the labels of a file
      sayJoined(outcome);
    }
  } else {
    moveBetween(past);
  }
  takeLabels(outcome.labels);
  saveLabels();
}

void Desktop::sayJoined(const LabelWorker::Outcome& outcome) {
  ui::MessageModel message;
  message.happened = "The labels of the file are in the case.";
  if (!outcome.added.empty()) message.meaning = "New: " + listed(outcome.added) + ". ";
  if (!outcome.replaced.empty()) message.meaning += "Replaced: " + listed(outcome.replaced) + ".";
  message.advice = "Undo takes them back.";
  say(std::move(message));
  for (const std::string& warning : outcome.warnings) {
    say({ui::MessageModel::Kind::Warning, warning, "", ""});
  }
}

/// The newest of one stack was carried out: it becomes the newest of the other.
void Desktop::moveBetween(UndoEntry past) {
  auto& from = restoring_ == Restoring::Undo ? undo_ : redo_;
  auto& to = restoring_ == Restoring::Undo ? redo_ : undo_;
  restoring_ = Restoring::No;
  if (from.empty()) return;
  past.what = from.back().what;
  recipe_ = from.back().recipe;
  from.pop_back();
  to.push_back(std::move(past));
}

void Desktop::takePreview(const LabelWorker::Outcome& outcome) {
  ui::SegmentModel& segment = model_.segment;
  segment.previewRefused = outcome.labels == nullptr;
  if (segment.previewRefused) {
    const bool stopped = outcome.error.kind == ErrorKind::Cancelled;
    segment.previewText = stopped ? std::string() : sentence(plain(outcome.error));
    return;
  }
  segment.previewText = compared(outcome.voxelsBefore, outcome.voxelsAfter);
  segment.previewShown = true;
  workspace_->showPreview(outcome.labels->grid);
  workspace_->showRows(rowsOf(*outcome.labels));
}

void Desktop::takeSurfaces(LabelWorker::Outcome& outcome) {
  for (LabelSurface& surface : outcome.surfaces) {
    workspace_->showSurface(surface.value, surface.chunks);
    if (outcome.surfacesOfPreview) {
      previewed_.insert(surface.value);
    } else {
      previewed_.erase(surface.value);
      surfaces_[surface.value] = std::move(surface.chunks);
    }
  }
  const SharedLabels& drawn = outcome.labels;
  workspace_->showRows(outcome.surfacesOfPreview ? rowsOf(*drawn) : model_.segment.labels);
  workspace_->frameSurfaces();
}

void Desktop::dropPreview() {
  labelWorker_.dropPreview();
  ui::SegmentModel& segment = model_.segment;
  segment.previewText.clear();
  segment.previewRefused = false;
  if (segment.previewShown) {
    workspace_->showLabels(open_ && !open_->labels->empty() ? open_->labels->grid : nullptr);
  }
  segment.previewShown = false;
  for (const std::uint8_t value : previewed_) {
    const auto own = surfaces_.find(value);
    workspace_->showSurface(value, own == surfaces_.end()
                                       ? std::make_shared<const std::vector<SurfaceChunk>>()
                                       : own->second);
  }
  previewed_.clear();
  workspace_->keepSurfaces(segment.labels);
  workspace_->showRows(segment.labels);
}

void Desktop::applyStepNow(const LabelStep& step) {
  if (!open_) return;
  model_.segment.previewText.clear();
  labelWorker_.commit(step);
}

void Desktop::editLabel(const ui::act::EditLabel& wish) {
  if (!open_) return;
  if (labelWorker_.busy()) return afterSteps_.push_back([this, wish] { editLabel(wish); });
  LabelTable table = open_->labels->table;
  const auto row = std::find_if(table.begin(), table.end(),
                                [&](const LabelInfo& l) { return l.value == wish.value; });
  if (row == table.end()) return;
  const auto same = [&](const LabelInfo& l) {
    return l.name == wish.name && l.value != wish.value;
  };
  if (std::any_of(table.begin(), table.end(), same)) {
    return complain(usageError("Another label has that name.").advise("Choose another name."));
  }
  leaveSegment();  // the preview comes back, of the label as it is then called
  undo_.push_back({nullptr, open_->labels->table, "Edit, " + row->name, recipe_});
  redo_.clear();
  renameLabel(recipe_.steps, row->name, wish.name);
  *row = {wish.name, wish.value, wish.colour, wish.material};
  setTable(table);
}

void Desktop::setTable(const LabelTable& table) {
  takeLabels(labelWorker_.setTable(table));
  saveLabels();
}

void Desktop::restore(Restoring which) {
  auto& from = which == Restoring::Undo ? undo_ : redo_;
  if (!open_) return;
  if (labelWorker_.busy()) return afterSteps_.push_back([this, which] { restore(which); });
  if (from.empty()) return;
  dropPreview();
  restoring_ = which;
  if (from.back().state) return labelWorker_.restore(from.back().state);
  const LabelTable table = from.back().table;
  moveBetween({nullptr, open_->labels->table, "", recipe_});
  setTable(table);
}

void Desktop::saveLabels() {
  unsaved_ = true;
  const auto save = [this, labels = open_->labels, recipe = recipe_,
                     folder = open_->folder](const Progress& progress) {
    progress(0.2, "Writing labels.mha");
    const Result<void> written = writeLabels(folder, *labels, recipe);
    return [this, labels, written] {
      if (!written) {
        return complain(written.error(), "The labels are in memory only: save them elsewhere.");
      }
      if (open_ && open_->labels == labels) unsaved_ = false;
    };
  };
  jobs_.addLatest("Saving the labels", save, false);
}

void Desktop::saveBeforeClosing() {
  labelWorker_.finish();
  pollLabels();
  if (!open_ || !unsaved_) return;
  (void)writeLabels(open_->folder, *open_->labels, recipe_);
  unsaved_ = false;
}

void Desktop::meshLabels() {
  jobs_.add("Drawing the surface", [this, step = meshStep(), labels = open_->labels,
                                    volume = open_->volume](const Progress& progress) {
    auto surfaces = std::make_shared<Result<std::vector<LabelSurface>>>(
        surfacesOf(*labels->grid, labels->table, *volume, step, progress));
    return [this, surfaces, labels] {
      if (!open_ || open_->labels != labels) return;
      if (!*surfaces) return complain(surfaces->error(), "The slices and the feel are unaffected.");
      for (LabelSurface& surface : **surfaces) {
        workspace_->showSurface(surface.value, surface.chunks);
        surfaces_[surface.value] = std::move(surface.chunks);
      }
      workspace_->showRows(model_.segment.labels);
      workspace_->frameSurfaces();
    };
  });
}

/// What was only previewed is not what the other tasks show.
void Desktop::leaveSegment() {
  dropPreview();
  workspace_->segment().sentKey.clear();
}

void Desktop::touchIt() {
  leaveSegment();
  model_.task = ui::Task::Simulate;
  if (simulation_.running()) return;
  if (simulation_.scene() != nullptr && !jobs_.busy()) return startStop();
  startAfterPrepare_ = true;
}

}  // namespace palpate
