/// Labels of the open case: made, removed, undone; then their surface and the scene to feel.

#include <algorithm>

#include "app/desktop_loop.h"
#include "app/scene_loading.h"
#include "imaging/segmentation.h"

namespace palpate {
namespace {

constexpr std::size_t kUndoSteps = 10;

/// The value of the label of that name, else the smallest that is free; 0: none is.
std::uint8_t valueFor(const LabelTable& table, const std::string& name) {
  for (const LabelInfo& label : table) {
    if (label.name == name) return label.value;
  }
  for (int value = 1; value < 256; ++value) {
    const bool taken = std::any_of(table.begin(), table.end(),
                                   [value](const LabelInfo& l) { return l.value == value; });
    if (!taken) return static_cast<std::uint8_t>(value);
  }
  return 0;
}

/// Labels and table on disk; a table without labels removes both files.
Result<void> writeLabels(const std::filesystem::path& folder, const LabelGrid* labels,
                         const LabelTable& table) {
  if (labels != nullptr && !table.empty()) return writeCaseLabels(folder, *labels, table);
  std::error_code error;
  std::filesystem::remove(folder / "labels.mha", error);
  std::filesystem::remove(folder / "labels.toml", error);
  if (error) {
    return fail(machineError("The labels could not be removed.").inFile(folder.string()));
  }
  return {};
}

}  // namespace

void Desktop::readDatasets() {
  auto instruments = readInstruments(options_.datasets / "instruments");
  if (!instruments) {
    complain(instruments.error(), "No instrument can be chosen.");
  } else {
    instruments_ = std::move(*instruments);
  }
  auto materials = readMaterials(options_.datasets / "materials.toml");
  if (!materials) {
    complain(materials.error(), "Nothing can be felt without materials.");
  } else {
    materials_ = std::move(*materials);
  }
  for (const Instrument& instrument : instruments_) {
    model_.simulate.instruments.push_back(describeInstrument(instrument));
  }
}

void Desktop::segmentTissue(const ui::act::Segment& wish) {
  if (!open_ || jobs_.busy()) return;
  stopRun();
  const std::uint8_t value = valueFor(open_->table, wish.label);
  if (value == 0) {
    complain(usageError("The case already has 255 labels.").advise("Remove one first."));
    return;
  }
  LabelTable table = open_->table;
  const auto same = [&wish](const LabelInfo& l) { return l.name == wish.label; };
  if (std::none_of(table.begin(), table.end(), same)) {
    table.push_back({wish.label, value, wish.colour, wish.material});
  }
  jobs_.add("Segmenting " + wish.label,
            [this, wish, value, table, volume = open_->volume, before = open_->labels,
             folder = open_->folder](const Progress& progress) {
              auto made = segment(*volume, before.get(), value, wish.request, progress);
              Result<void> written;
              std::shared_ptr<const LabelGrid> labels;
              if (made) {
                labels = std::make_shared<const LabelGrid>(std::move(*made));
                progress(0.95, "Saving the labels");
                written = writeLabels(folder, labels.get(), table);
              }
              return [this, labels, table, wish, written, error = made ? Error{} : made.error(),
                      ok = made.has_value()] {
                if (!ok) return complain(error, "The labels of the case are as they were.");
                if (!written)
                  return complain(written.error(), "The labels of the case are as they were.");
                undo_.push_back({open_->labels, open_->table, wish.label});
                if (undo_.size() > kUndoSteps) undo_.erase(undo_.begin());
                replaceLabels(labels, table);
              };
            });
}

void Desktop::deleteLabel(std::uint8_t value) {
  if (!open_ || !open_->labels || jobs_.busy()) return;
  stopRun();
  LabelTable table = open_->table;
  const auto found = std::find_if(table.begin(), table.end(),
                                  [value](const LabelInfo& l) { return l.value == value; });
  if (found == table.end()) return;
  const std::string name = found->name;
  table.erase(found);
  jobs_.add("Removing " + name, [this, value, name, table, before = open_->labels,
                                 folder = open_->folder](const Progress& progress) {
    progress(0.1, "Clearing its voxels");
    LabelGrid grid = *before;
    std::replace(grid.labels.begin(), grid.labels.end(), value, std::uint8_t{0});
    const auto labels = std::make_shared<const LabelGrid>(std::move(grid));
    progress(0.5, "Saving the labels");
    const Result<void> written = writeLabels(folder, labels.get(), table);
    return [this, labels, table, name, written] {
      if (!written) return complain(written.error(), "The label is still there.");
      undo_.push_back({open_->labels, open_->table, "removing " + name});
      replaceLabels(table.empty() ? nullptr : labels, table);
    };
  });
}

void Desktop::undo() {
  if (undo_.empty() || !open_ || jobs_.busy()) return;
  stopRun();
  const LabelState state = undo_.back();
  jobs_.add("Undoing", [this, state, folder = open_->folder](const Progress& progress) {
    progress(0.2, "Saving the labels");
    const Result<void> written = writeLabels(folder, state.labels.get(), state.table);
    return [this, state, written] {
      if (!written) return complain(written.error(), "Nothing was undone.");
      undo_.pop_back();
      replaceLabels(state.labels, state.table);
    };
  });
}

void Desktop::replaceLabels(std::shared_ptr<const LabelGrid> labels, LabelTable table) {
  open_->labels = std::move(labels);
  open_->table = std::move(table);
  labelsChanged();
}

void Desktop::labelsChanged() {
  workspace_->showLabels(open_->labels.get());
  model_.segment.labels = labelRows(*open_);
  model_.segment.undo = undo_.empty() ? std::string() : undo_.back().what;
  workspace_->clearSurfaces();
  workspace_->showRows(model_.segment.labels);
  simulation_.setScene(nullptr);
  model_.simulate.accuracy.clear();
  model_.simulate.notReady = "Nothing is labelled yet, so there is nothing to feel.";
  if (!open_->labels || open_->table.empty()) return;
  meshLabels();
  prepare();
}

void Desktop::meshLabels() {
  // Software rendering is bound by vertices: half the resolution is a quarter of them.
  const int step = window_->softwareRendering() && open_->volume->size() > 12'000'000 ? 2 : 1;
  jobs_.add("Drawing the surface", [this, step, labels = open_->labels, table = open_->table,
                                    volume = open_->volume](const Progress& progress) {
    auto surfaces = std::make_shared<Result<std::vector<LabelSurface>>>(
        surfacesOf(*labels, table, *volume, step, progress));
    return [this, surfaces, labels] {
      if (!open_ || open_->labels != labels) return;
      if (!*surfaces) return complain(surfaces->error(), "The slices and the feel are unaffected.");
      for (const LabelSurface& surface : **surfaces) {
        workspace_->showSurface(surface.value, surface.chunks);
      }
      workspace_->showRows(model_.segment.labels);
      workspace_->frameSurfaces();
    };
  });
}

namespace {

/// A body that cannot be drawn is still felt; it is left out of the picture.
std::vector<ui::BodySurface> bodySurfacesOf(const PreparedScene& scene, const Progress& progress) {
  std::vector<ui::BodySurface> surfaces;
  for (const PreparedBody& body : scene.bodies) {
    ui::BodySurface& surface = surfaces.emplace_back();
    surface.label = body.label;
    for (const LabelInfo& row : scene.table) {
      if (row.value == body.label) surface.colour = row.colour;
    }
    auto chunks = meshLabel(*body.voxels, body.label, 1, progress);
    if (chunks) surface.chunks = std::move(*chunks);
  }
  return surfaces;
}

}  // namespace

void Desktop::prepare() {
  if (!open_ || !open_->labels || instruments_.empty() || materials_.empty()) return;
  model_.simulate.notReady = "The anatomy is being made ready to feel.";
  auto scene = loadSceneFile(open_->folder);
  if (!scene) {
    complain(scene.error(), "The case's own scene is not used; the default is.");
    scene = defaultScene();
  }
  if (!sceneInstrument_.empty()) scene->instrument = sceneInstrument_;
  const auto named = std::find_if(instruments_.begin(), instruments_.end(),
                                  [&](const auto& i) { return i.name == scene->instrument; });
  const Instrument instrument = named == instruments_.end() ? instruments_.front() : *named;
  scene->instrument = instrument.name;
  for (std::size_t i = 0; i < instruments_.size(); ++i) {
    if (instruments_[i].name == instrument.name) model_.simulate.instrument = i;
  }
  workspace_->showInstrument(instrument);
  jobs_.add("Building the sphere tree", [this, scene = *scene, instrument, labels = open_->labels,
                                         table = open_->table, materials = materials_,
                                         folder = open_->folder](const Progress& progress) {
    auto prepared = prepareScene(scene, labels, table, materials, instrument, progress, folder);
    auto bodies = std::make_shared<std::vector<ui::BodySurface>>();
    if (prepared) *bodies = bodySurfacesOf(**prepared, progress);
    return [this, prepared, labels, bodies] {
      if (!open_ || open_->labels != labels) return;
      workspace_->showBodies(*bodies);
      if (!prepared) {
        model_.simulate.notReady = sentence(prepared.error());
        if (prepared.error().kind != ErrorKind::Cancelled) complain(prepared.error());
        return;
      }
      simulation_.setScene(*prepared);
      if (startAfterPrepare_) {
        startAfterPrepare_ = false;
        startStop();
      }
    };
  });
}

}  // namespace palpate
