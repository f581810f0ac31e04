#include "ui/workspace.h"

#include <imgui.h>

#include <imgui_internal.h>  // after imgui.h: closing a list by Escape, items over others

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/geometry/units.h"
#include "ui/header.h"
#include "ui/icons.h"
#include "ui/scene_overlay.h"
#include "ui/strip.h"
#include "ui/view_edit.h"

namespace palpate::ui {

Result<std::unique_ptr<Workspace>> Workspace::load(const std::filesystem::path& shaders) {
  std::unique_ptr<Workspace> self(new Workspace);
  auto scene = SceneView::load(shaders);
  if (!scene) return fail(scene.error());
  self->scene_ = std::move(*scene);
  auto slice = GlProgram::load(shaders, "fullscreen.vert", "slice.frag");
  if (!slice) return fail(slice.error());
  self->sliceProgram_ = std::move(*slice);
  return self;
}

VolumeLook lookOf(const Volume& volume) {
  return {startingWindow(volume), brickMaxima(volume, VolumeTextures::kBrick)};
}

void Workspace::showVolume(std::shared_ptr<const Volume> volume, const VolumeLook& look) {
  exchange_ = {};
  modality_ = volume->modality;
  followedStep_ = ~std::uint64_t{0};
  const Rect& area = layout_.view[0];
  const double aspect = area.h > 0.0F ? static_cast<double>(area.w / area.h) : 1.0;
  resetViews(state_, volume->geometry, look.window, aspect);
  textures_.setVolume(std::move(volume), look.bricks);
  startCamera_ = state_.camera;
  scene_->setOrigin(state_.camera.target_mm);
  scene_->volume().setTransfer(transferFor(modality_, state_.window));
  scene_->surface().clear();
}

void Workspace::showLabels(std::shared_ptr<const LabelGrid> labels) {
  labels_ = std::move(labels);
  showPreview(labels_);
}

void Workspace::showPreview(std::shared_ptr<const LabelGrid> labels) {
  seen_ = std::move(labels);
  if (seen_ == nullptr || seen_->labels.empty()) {
    textures_.dropLabels();
  } else {
    textures_.setLabels(seen_);
  }
}

void Workspace::showRows(const std::vector<LabelRow>& rows) {
  textures_.setPalette(rows);
  scene_->surface().setRows(rows);
}

void Workspace::showSurface(std::uint8_t label, SharedChunks chunks) {
  scene_->surface().setLabel(label, std::move(chunks), scene_->origin_mm());
  scene_->surface().setLoose(loose_);
}

void Workspace::showBodies(const std::vector<BodySurface>& bodies) {
  loose_.clear();
  for (const BodySurface& body : bodies) loose_.push_back(body.label);
  scene_->bodies().setBodies(bodies, scene_->origin_mm());
  scene_->surface().setLoose(loose_);
}

void Workspace::frameSurfaces() {
  const auto box = scene_->surface().bounds_mm();
  if (!box || !(state_.camera == startCamera_)) return;
  const Rect& area = layout_.view[0];
  const double aspect = area.h > 0.0F ? static_cast<double>(area.w / area.h) : 1.0;
  state_.camera.frame((*box)[0], (*box)[1], aspect);
  startCamera_ = state_.camera;
}

void Workspace::keepSurfaces(const std::vector<LabelRow>& rows) {
  scene_->surface().keep(rows);
}

void Workspace::clearSurfaces() {
  showBodies({});
  scene_->surface().clear();
}

void Workspace::showInstrument(const Instrument& instrument) {
  instrument_ = instrument.mesh_T;
  scene_->tool().setInstrument(instrument);
}

void Workspace::clearCase() {
  labels_.reset();
  seen_.reset();
  textures_.clear();
  showBodies({});
  scene_->surface().clear();
}

int Workspace::picturesMade() const {
  int sum = scene_->rendered();
  for (const SliceView& slice : slices_) sum += slice.rendered();
  return sum;
}

void Workspace::centreOn(const Eigen::Vector3d& p_P) {
  state_.camera.target_mm = p_P * kMillimetresPerMetre;
  state_.camera.distance_mm = std::min(state_.camera.distance_mm, 260.0);
  state_.crosshair_P = p_P;
}

void Workspace::readKeys(Window& window, const Model& model, Actions& actions) {
  for (const std::string& key : window.takeKeys()) {
    if (key == "escape") {
      // Force off first and always; the rest is only the view's.
      actions.push_back(act::ForceOff{});
      if (model.simulate.grabbed) actions.push_back(act::Grab{false});
      // One thing a press, the nearest first.
      if (const int open = ImGui::GetCurrentContext()->OpenPopupStack.Size; open > 0) {
        ImGui::ClosePopupToLevel(open - 1, true);
      } else if (help_) {
        help_ = false;
      } else if (!ImGui::GetIO().WantTextInput &&
                 (model.task != Task::Segment || !segment_.abandon())) {
        fill(std::nullopt);
      }
    } else if (ImGui::GetTopMostPopupModal() != nullptr) {
      continue;  // a dialog is open: it is answered first
    } else if (key.size() == 1 && key[0] >= '1' && key[0] <= '4') {
      actions.push_back(act::ShowTask{static_cast<Task>(key[0] - '1')});
    } else if (key == "space") {
      actions.push_back(act::StartStop{});
    } else if (key == "r") {
      actions.push_back(act::Record{});
    } else if (key == "g") {
      actions.push_back(act::Grab{!model.simulate.grabbed});
    } else if (key == "f" && model.snapshot != nullptr) {
      centreOn(position(model.snapshot->tool));
    } else if (key == "a" && model.simulate.latch && model.simulate.running) {
      actions.push_back(act::Arm{!model.simulate.armed});
    } else if (key == "ctrl+z") {
      actions.push_back(act::Undo{});
    } else if (key == "ctrl+y") {
      actions.push_back(act::Redo{});
    } else if (key == "v") {
      state_.volumeRendering = !state_.volumeRendering;
    } else if (key == "?") {
      help_ = !help_;
    }
  }
  // Held: the key, or the left button of the mouse that holds the instrument (seen last frame).
  const bool key = window.keyHeld("a") && !ImGui::GetIO().WantTextInput;
  const bool arm = (key || gripped_) && !model.simulate.latch;
  if (arm != armHeld_) actions.push_back(act::Arm{arm});
  armHeld_ = arm;
  moveByKeys(window, model, actions);
}

/// The arrows move the hand across the view, page up and down into it and out; Ctrl: finely.
void Workspace::moveByKeys(const Window& window, const Model& model, Actions& actions) const {
  const SimulateModel& simulate = model.simulate;
  const ImGuiIO& io = ImGui::GetIO();
  if (!simulate.running || simulate.hardware || simulate.hand != HandKind::Mouse ||
      io.WantTextInput) {
    return;
  }
  const auto axis = [&window](const char* less, const char* more) {
    return (window.keyHeld(more) ? 1.0 : 0.0) - (window.keyHeld(less) ? 1.0 : 0.0);
  };
  const Eigen::Vector3d wish(axis("left", "right"), axis("down", "up"), axis("pageup", "pagedown"));
  if (wish.isZero()) return;
  constexpr double kSpeed = 0.03, kFine = 0.005;  // m/s
  const double seconds = std::min(0.1, static_cast<double>(io.DeltaTime));
  const double speed = window.keyHeld("ctrl") ? kFine : kSpeed;
  actions.push_back(act::MoveHand{state_.camera.q_PC * (speed * seconds * wish)});
}

/// An instrument that rests is only in the way of the tools of Segment.
const Snapshot* Workspace::shownSnapshot(const Model& model) {
  const bool rests = model.task == Task::Segment && !model.simulate.running;
  return rests ? nullptr : model.snapshot;
}

PlacedMesh Workspace::placedTool(const Model& model) const {
  PlacedMesh placed;
  const Snapshot* snapshot = shownSnapshot(model);
  if (snapshot == nullptr || instrument_.triangles.empty()) return placed;
  placed.vertices_T = &instrument_.vertices;
  placed.triangles = &instrument_.triangles;
  placed.X_PT = isometry(snapshot->tool);
  return placed;
}

void Workspace::drawPanel(const Painter& paint, const Model& model, double now) {
  const Rect& area = layout_.panel;
  if (area.w < 1.0F || area.h < 1.0F) return;
  ImGui::GetWindowDrawList()->AddRectFilled({area.x, area.y}, {area.right(), area.bottom()},
                                            packed(paint.theme.panel));
  ImGui::SetCursorScreenPos({area.x, area.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding,
                      {paint.px(Measures::kPadding), paint.px(Measures::kPadding)});
  // A child of its own for each task: each keeps its place when scrolled.
  // Segment has a part of its own that scrolls.
  ImGui::BeginChild(taskName(model.task), {area.w, area.h}, false,
                    ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NoBackground |
                        (model.task == Task::Segment
                             ? ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse
                             : 0));
  ImGui::PopStyleVar();
  if (model.task != Task::Segment) state_.preview.reset();
  switch (model.task) {
    case Task::Library:
      drawLibraryPanel(paint, model, library_);
      break;
    case Task::Segment:
      drawSegmentPanel(paint, model, segment_, exchange_, state_, now);
      break;
    case Task::Simulate:
      drawSimulatePanel(paint, model, spaceHolds_);
      break;
    case Task::Review:
      drawReviewPanel(paint, model);
      break;
  }
  ImGui::EndChild();
}

void Workspace::drawEmptyScene(const Painter& paint, const Rect& area, const Model& model) const {
  if (model.openCase.open &&
      (!scene_->surface().empty() || model.job.active || state_.volumeRendering)) {
    return;
  }
  const std::string title = model.openCase.open ? "Nothing is labelled yet" : "No case is open";
  const std::string advice = model.openCase.open
                                 ? "Segment bone or tissue to see it here and to feel it."
                                 : "Open the demo or import a scan in the Library.";
  ImDrawList* list = ImGui::GetWindowDrawList();
  float y = area.y + 0.5F * area.h - paint.px(24.0F);
  for (const auto& [font, text, colour] :
       {std::tuple{paint.fonts.heading, title, paint.theme.text},
        std::tuple{paint.fonts.body, advice, paint.theme.secondary}}) {
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, text.c_str());
    list->AddText(font, font->FontSize,
                  {std::round(area.x + 0.5F * (area.w - size.x)), std::round(y)}, packed(colour),
                  text.c_str());
    y += size.y + paint.px(8.0F);
  }
}

void Workspace::drawSceneTools(const Painter& paint, const Rect& area, const Model& model) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float inset = paint.px(10.0F);
  ImFont* small = paint.fonts.secondary;
  const char* what = !model.openCase.open        ? ""
                     : state_.volumeRendering    ? "Volume rendering"
                     : scene_->surface().empty() ? ""
                                                 : "Surface";
  list->AddText(small, small->FontSize, {area.x + inset, area.y + inset},
                packed(paint.theme.secondary), what);
  const float side = paint.px(28.0F);
  float x = area.right() - inset - side;
  const auto place = [&] {
    ImGui::SetCursorScreenPos({x, area.y + paint.px(6.0F)});
    x -= side + paint.px(4.0F);
  };
  place();
  const bool filled = state_.filled.has_value();
  if (iconButton(paint, filled ? icon::kCompress : icon::kExpand,
                 filled ? "Smaller (Esc)" : "Fill the window")) {
    fill(filled ? std::nullopt : std::optional(View::Scene));
  }
  place();
  if (iconButton(paint, icon::kSun, "Light or dark")) paint.actions.push_back(act::SwitchTheme{});
  place();
  if (iconButton(paint, icon::kCrosshair, "Centre on the instrument (F)", false,
                 model.snapshot != nullptr)) {
    centreOn(position(model.snapshot->tool));
  }
  place();
  if (iconButton(paint, icon::kCube, "Volume rendering (V)", state_.volumeRendering,
                 textures_.loaded())) {
    state_.volumeRendering = !state_.volumeRendering;
  }
  if (textures_.loaded()) {
    const float r = paint.px(30.0F);
    drawOrientationCube(*list, state_.camera,
                        {area.x + inset + 1.25F * r, area.bottom() - inset - 1.25F * r}, r,
                        paint.theme, small);
  }
}

void Workspace::drawScene(const Painter& paint, const Rect& area, const Model& model, bool shift,
                          double now, bool patient) {
  ImGui::SetCursorScreenPos({area.x, area.y});
  // Under its buttons: what is pressed there does not reach the tools.
  ImGui::InvisibleButton("scene", {std::max(1.0F, area.w), std::max(1.0F, area.h)},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle |
                             static_cast<int>(ImGuiButtonFlags_AllowItemOverlap));
  ImGui::SetItemAllowOverlap();
  paint.note("3D view");
  const bool mouseHand =
      model.simulate.running && model.simulate.hand == HandKind::Mouse && model.snapshot != nullptr;
  const bool holding = mouseHand && (model.simulate.grabbed || shift);
  const bool edits = model.task == Task::Segment && model.openCase.open;
  const ScenePicks picks{seen_.get(), labels_.get(), chosenValue(model), hiddenLabels(model)};
  const bool taken = edits && editInScene(segment_, state_.camera, area, picks, paint.actions);
  if (!taken && interactWithScene(state_.camera, area, holding, paint.actions)) {
    fill(state_.filled ? std::nullopt : std::optional(View::Scene));
  }
  gripped_ = holding && ImGui::IsItemActive() && ImGui::IsMouseDown(0);
  scene_->draw(area, textures_, state_, shownSnapshot(model), paint.theme, now, patient);
  if (edits) drawEditInScene(segment_, state_.camera, area, picks, paint.theme, paint.scale);
  if (holding) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    ImGui::GetWindowDrawList()->AddRect({area.x + 1, area.y + 1},
                                        {area.right() - 1, area.bottom() - 1},
                                        packed(paint.theme.accent, 0.8F), 0.0F, 0, paint.px(2.0F));
  }
  drawEmptyScene(paint, area, model);
  drawSceneTools(paint, area, model);
}

std::vector<std::uint8_t> Workspace::hiddenLabels(const Model& model) const {
  std::vector<std::uint8_t> hidden;
  for (const LabelRow& row : model.segment.labels) {
    if (!row.visible) hidden.push_back(row.value);
  }
  return hidden;
}

std::uint8_t Workspace::chosenValue(const Model& model) const {
  for (const LabelRow& row : model.segment.labels) {
    if (row.name == segment_.label) return row.value;
  }
  return 0;
}

SliceTool Workspace::toolFor(const Painter& paint, const Model& model, View view) {
  if (model.task != Task::Segment || !model.openCase.open) return {};
  SliceTool tool;
  tool.takes = [this, &paint, &model, view](const Rect& area, const SlicePlane& plane,
                                            const SliceFit& fit, double slice) {
    const SliceMouse at{labels_.get(), chosenValue(model), view, area, textures_.grid(), plane, fit,
                        slice};
    return editInSlice(segment_, at, paint.actions);
  };
  tool.draws = [this, view](const SliceOverlay& over) { drawEditInSlice(segment_, over, view); };
  return tool;
}

void Workspace::drawViews(const Painter& paint, const Model& model, bool shift, double now,
                          bool patient) {
  state_.edgeOpacity = model.task == Task::Segment ? 0.9F : 0.0F;
  const auto shown = [this](View view) { return !state_.filled || *state_.filled == view; };
  if (shown(View::Scene)) {
    drawScene(paint, layout_.view[0], model, shift, now, patient);
  }
  // Slices follow the tip only while the mouse or the demo moves it, and not in between steps.
  if (model.snapshot != nullptr && state_.followTool && model.snapshot->step != followedStep_ &&
      (gripped_ || !ImGui::IsMouseDown(0))) {
    followedStep_ = model.snapshot->step;
    state_.crosshair_P = position(model.snapshot->tool);
  }
  const PlacedMesh tool = placedTool(model);
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    const auto view = static_cast<View>(i + 1);
    if (!shown(view)) continue;
    if (slices_[i].draw(layout_.view[i + 1], textures_, sliceProgram_, state_, tool,
                        shownSnapshot(model), toolFor(paint, model, view), paint.theme,
                        paint.fonts.secondary, paint.scale)) {
      fill(state_.filled ? std::nullopt : std::optional(view));
    }
    drawEnlarge(paint, view);
  }
}

/// Tools take the double-click of a slice: a button enlarges it too, shown while the mouse is
/// there.
void Workspace::drawEnlarge(const Painter& paint, View view) {
  const Rect& area = layout_.view[static_cast<std::size_t>(view)];
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (!textures_.loaded() || !area.contains(mouse.x, mouse.y) || segment_.drawingIn) return;
  const bool filled = state_.filled == view;
  const float side = paint.px(28.0F);
  ImGui::SetCursorScreenPos({area.right() - side - paint.px(4.0F), area.y + paint.px(26.0F)});
  ImGui::PushID(static_cast<int>(view));
  if (iconButton(paint, filled ? icon::kCompress : icon::kExpand,
                 filled ? "Smaller (Esc)" : "Fill the window with this slice")) {
    fill(filled ? std::nullopt : std::optional(view));
  }
  ImGui::PopID();
}

/// Texts from outside, in whatever script.
void Workspace::needCharacters(Window& window, const Model& model) const {
  const auto need = [&window](const std::string& text) { window.needCharacters(text); };
  need(model.openCase.title);
  for (const auto& text : model.openCase.warnings) need(text);
  const LibraryModel& library = model.library;
  for (const SeriesRow& series : library.series) {
    for (const std::string* text : {&series.title, &series.study, &series.reason}) need(*text);
  }
  for (const RecentCase& recent : library.recent) {
    need(recent.title);
    need(recent.detail);
  }
  need(library.directory.string());
  for (const DirectoryRow& entry : library.entries) need(entry.name);
  for (const LabelRow& label : model.segment.labels) need(label.name);
  for (const MessageModel& message : model.messages) {
    for (const std::string* text : {&message.happened, &message.meaning, &message.advice}) {
      need(*text);
    }
  }
  need(model.job.what);
  need(library_.path);
  need(segment_.name);
  need(segment_.editName);
  for (const std::string& part : segment_.parts) need(part);
  for (const std::string* text : {&exchange_.path, &exchange_.from, &exchange_.only}) need(*text);
  need(model.segment.exchange.folder.string());
  for (const DirectoryRow& entry : model.segment.exchange.entries) need(entry.name);
}

/// Volume and labels before surfaces: a stroke is looked for in the slice.
void Workspace::send(bool all) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kSend(10);  // with software rendering's bands under 33 ms
  const auto until = all ? Clock::time_point::max() : Clock::now() + kSend;
  textures_.send(until);
  if (Clock::now() < until) scene_->surface().send(until);
}

Actions Workspace::draw(Window& window, const Model& model, double now, bool patient) {
  send(!patient);
  Actions actions;
  items_.clear();
  needCharacters(window, model);
  readKeys(window, model, actions);
  const auto width = static_cast<float>(window.width());
  const auto height = static_cast<float>(window.height());
  layout_ = computeLayout(width, height, window.scale(), state_.filled);
  const Painter paint{window.theme(), window.fonts(), window.scale(), actions, items_};

  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0F);
  ImGui::Begin("Palpate", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PopStyleVar(2);
  drawViews(paint, model, window.keyHeld("shift"), now, patient);
  if (!state_.filled) drawPanel(paint, model, now);
  drawHeader(paint, layout_.header, model);
  drawStrip(paint, layout_.strip, model);
  ImGui::End();

  const Rect& middle =
      state_.filled ? layout_.view[static_cast<std::size_t>(*state_.filled)] : layout_.view[0];
  drawJob(paint, middle, model.job);
  drawMessages(paint, middle, model.messages);
  const Rect whole{0, 0, width, height};
  drawShortcuts(paint, whole, help_);
  drawExchange(paint, whole, model, exchange_, segment_.label);
  if (model.askClose) drawCloseQuestion(paint, whole);
  return actions;
}

}  // namespace palpate::ui
