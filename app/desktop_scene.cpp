/// The scene to feel: datasets, the anatomy's tree made ready beside the window, and its bodies.

#include <algorithm>

#include "app/desktop_loop.h"
#include "app/scene_loading.h"
#include "core/simulation/plan_cost.h"
#include "imaging/surface.h"

namespace palpate {

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
  for (const Material& material : materials_) {
    model_.segment.materials.push_back({material.name, material.stiffness_NPerMm, material.friction,
                                        material.density_kgPerM3, material.critical});
  }
  auto anatomies = readAnatomies(options_.datasets / "labels.toml");
  if (!anatomies) {
    complain(anatomies.error(), "Labels have no usual names, colours and materials to choose.");
  } else {
    for (const Anatomy& anatomy : *anatomies) {
      model_.segment.anatomies.push_back(
          {anatomy.name, anatomy.title, anatomy.colour, anatomy.material});
    }
    labelWorker_.setAnatomies(std::move(*anatomies));
  }
  for (const Instrument& instrument : instruments_) {
    model_.simulate.instruments.push_back(describeInstrument(instrument));
  }
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

void Desktop::takeScene(const std::shared_ptr<const PreparedScene>& scene) {
  if (simulation_.recording()) stopRun();  // a session holds one anatomy
  const bool running = simulation_.running();
  if (auto taken = simulation_.replaceScene(scene); !taken) return complain(taken.error());
  if (!running) return;
  say({ui::MessageModel::Kind::Information, "The simulation goes on with the new anatomy.",
       "The force was let go; it comes back when the instrument is free and you hold it again.",
       ""});
}

void Desktop::prepare() {
  if (!open_ || open_->labels->empty() || instruments_.empty() || materials_.empty()) return;
  model_.simulate.notReady = "The anatomy is being made ready to feel.";
  auto scene = loadSceneFile(open_->folder);
  if (!scene) {
    complain(scene.error(), "The case's own scene is not used; the default is.");
    scene = defaultScene();
  }
  ownSetting_ = scene->setting;
  if (!sceneInstrument_.empty()) scene->instrument = sceneInstrument_;
  knowWorkspace(*scene);
  const auto named = std::find_if(instruments_.begin(), instruments_.end(),
                                  [&](const auto& i) { return i.name == scene->instrument; });
  const Instrument instrument = named == instruments_.end() ? instruments_.front() : *named;
  scene->instrument = instrument.name;
  for (std::size_t i = 0; i < instruments_.size(); ++i) {
    if (instruments_[i].name == instrument.name) model_.simulate.instrument = i;
  }
  // What was chosen stays, also for edited labels; another instrument may not have it.
  const auto chosen = settingOfRow(appliedTrade_, ownSetting_, instrument);
  if (chosen) {
    scene->setting = *chosen;
  } else {
    appliedTrade_ = "default";
  }
  workspace_->showInstrument(instrument);
  jobs_.addLatest("Building the sphere tree",
                  [this, scene = *scene, instrument, labels = open_->labels, materials = materials_,
                   folder = open_->folder, own = ownSetting_,
                   device = simulation_.info().model](const Progress& progress) {
                    auto prepared = prepareScene(scene, labels->grid, labels->table, materials,
                                                 instrument, progress, folder);
                    auto bodies = std::make_shared<std::vector<ui::BodySurface>>();
                    if (prepared) *bodies = bodySurfacesOf(**prepared, progress);
                    // Steps alone: the tree of what is left out is not worth its time here.
                    auto plan = prepared ? measuredPlan(*prepared, WholeTree::Skip, progress)
                                         : Result<std::vector<PlanRow>>(std::vector<PlanRow>{});
                    const std::string key =
                        prepared ? tradeKey(**prepared, own, device) : std::string();
                    return [this, prepared, labels, bodies, plan, key] {
                      if (!open_ || open_->labels != labels) return;
                      workspace_->showBodies(*bodies);
                      if (!prepared) {
                        model_.simulate.notReady = sentence(prepared.error());
                        if (prepared.error().kind != ErrorKind::Cancelled)
                          complain(prepared.error());
                        return;
                      }
                      if (plan) model_.simulate.plan = *plan;
                      takeScene(*prepared);
                      considerTrade(key);
                      if (startAfterPrepare_) {
                        startAfterPrepare_ = false;
                        startStop();
                      }
                    };
                  });
}

}  // namespace palpate
