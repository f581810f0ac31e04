#include "ui/scene_view.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ui/gl_api.h"

namespace palpate::ui {
namespace {

constexpr double kRest_s = 0.18;       // the camera counts as still after this
constexpr double kBand_ms = 18.0;      // a band of the full picture: a frame stays under 50 ms
constexpr int kSupersample = 2;        // of the full surface picture
constexpr float kOcclusion_mm = 7.0F;  // hollows about as wide as an instrument

Eigen::Vector3f rgb(const ImVec4& c) {
  return {c.x, c.y, c.z};
}

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

double aspectOf(const GlFramebuffer& target) {
  return static_cast<double>(target.width()) / std::max(1, target.height());
}

}  // namespace

Result<std::unique_ptr<SceneView>> SceneView::load(const std::filesystem::path& shaders) {
  auto self = std::make_unique<SceneView>();
  const auto take = [&shaders](GlProgram& into, const char* vertex,
                               const char* fragment) -> Result<void> {
    auto program = GlProgram::load(shaders, vertex, fragment);
    if (!program) return fail(program.error());
    into = std::move(*program);
    return {};
  };
  if (auto ok = take(self->backdrop_, "fullscreen.vert", "backdrop.frag"); !ok) {
    return fail(ok.error());
  }
  if (auto ok = take(self->anatomy_, "mesh.vert", "anatomy.frag"); !ok) return fail(ok.error());
  if (auto ok = take(self->occlusion_, "fullscreen.vert", "occlusion.frag"); !ok) {
    return fail(ok.error());
  }
  auto tool = ToolLayer::load(shaders);
  if (!tool) return fail(tool.error());
  self->tool_ = std::move(*tool);
  auto volume = VolumeLayer::load(shaders);
  if (!volume) return fail(volume.error());
  self->volume_ = std::move(*volume);
  auto contacts = ContactImpostors::load(shaders);
  if (!contacts) return fail(contacts.error());
  self->contacts_ = std::move(*contacts);
  return self;
}

void SceneView::drawBackdrop(const GlFramebuffer& target, const Theme& theme) const {
  target.bind();
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  backdrop_.use();
  backdrop_.set("centreColour", rgb(theme.light ? theme.panel : theme.raised));
  backdrop_.set("edgeColour", rgb(theme.light ? theme.hover : theme.ground));
  drawFullScreen();
}

void SceneView::drawSurface(const GlFramebuffer& target) const {
  target.bind();
  anatomy_.use();
  const Eigen::Matrix4f view = last_.camera.view(origin_mm_);
  anatomy_.set("modelView", view);
  anatomy_.set("normalMatrix", Eigen::Matrix3f(view.topLeftCorner<3, 3>()));
  anatomy_.set("projection", last_.camera.projection(aspectOf(target)));
  surface_.draw(anatomy_);
}

void SceneView::renderDraft(const VolumeTextures& textures, const Theme& theme) {
  ++rendered_;
  if (last_.volume && textures.loaded()) {
    const auto start = std::chrono::steady_clock::now();
    const int w = std::max(1, last_.width / draftDivisor_);
    const int h = std::max(1, last_.height / draftDivisor_);
    source_.resize(w, h);
    draft_.resize(w, h);
    drawBackdrop(source_, theme);
    draft_.bind();
    volume_.draw(textures, last_.camera, origin_mm_, w, h, 0, h, 1.5F, source_.colour());
    glFinish();
    const double ms = millisecondsSince(start);
    if (ms > 70.0) draftDivisor_ = std::min(6, draftDivisor_ + 1);
    if (ms < 25.0) draftDivisor_ = std::max(1, draftDivisor_ - 1);
  } else {
    draft_.resize(last_.width, last_.height);
    drawBackdrop(draft_, theme);
    drawSurface(draft_);
  }
  anatomyShown_ = &draft_;
  refined_ = false;
  fineStarted_ = false;
}

void SceneView::startFine(const VolumeTextures& textures, const Theme& theme) {
  const bool volume = last_.volume && textures.loaded();
  const int factor = volume ? 1 : kSupersample;
  source_.resize(last_.width * factor, last_.height * factor);
  fine_.resize(last_.width * factor, last_.height * factor);
  drawBackdrop(source_, theme);
  if (!volume) drawSurface(source_);
  fineStarted_ = true;
  fineRow_ = 0;
}

bool SceneView::continueFine(const VolumeTextures& textures, bool all) {
  const auto start = std::chrono::steady_clock::now();
  const int end = all ? fine_.height() : std::min(fine_.height(), fineRow_ + bandRows_);
  fine_.bind();
  if (last_.volume && textures.loaded()) {
    volume_.draw(textures, last_.camera, origin_mm_, fine_.width(), fine_.height(), fineRow_, end,
                 0.7F, source_.colour());
  } else {
    occlusion_.use();
    occlusion_.texture("colourMap", 0, GL_TEXTURE_2D, source_.colour());
    occlusion_.texture("depthMap", 1, GL_TEXTURE_2D, source_.depth());
    occlusion_.set("planes", Eigen::Vector2f(static_cast<float>(last_.camera.nearPlane()),
                                             static_cast<float>(last_.camera.farPlane())));
    occlusion_.set("radius", kOcclusion_mm);
    const double mmPerPixel = last_.camera.millimetresPerPixel(fine_.height());
    occlusion_.set("pixelsPerMm", static_cast<float>(last_.camera.distance_mm / mmPerPixel));
    occlusion_.set("enabled", 1);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, fineRow_, fine_.width(), end - fineRow_);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    drawFullScreen();
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
  }
  if (!all) {
    glFinish();
    const double ms = std::max(0.2, millisecondsSince(start));
    bandRows_ = std::clamp(static_cast<int>(bandRows_ * kBand_ms / ms), 8, 1024);
  }
  fineRow_ = end;
  return fineRow_ >= fine_.height();
}

void SceneView::composite(const Snapshot& snapshot, const Theme& theme) {
  // A coarse draft of the anatomy must not make the instrument coarse.
  composite_.resize(std::max(last_.width, anatomyShown_->width()),
                    std::max(last_.height, anatomyShown_->height()));
  composite_.copyFrom(*anatomyShown_);
  composite_.bind();
  const double aspect = aspectOf(composite_);
  const double height = composite_.height();
  bodies_.draw(anatomy_, snapshot, last_.camera, origin_mm_, aspect);
  contacts_.update(snapshot, origin_mm_);
  tool_.draw(snapshot, last_.camera, origin_mm_, aspect, height, theme);
  contacts_.draw(last_.camera, origin_mm_, aspect, height);
}

void SceneView::draw(const Rect& area, const VolumeTextures& textures, const ViewState& state,
                     const Snapshot* snapshot, const Theme& theme, double now, bool patient) {
  Inputs inputs;
  inputs.camera = state.camera;
  inputs.width = std::max(1, static_cast<int>(area.w));
  inputs.height = std::max(1, static_cast<int>(area.h));
  inputs.surface = surface_.version();
  inputs.textures = state.volumeRendering ? textures.version() : 0;
  inputs.volume = state.volumeRendering;
  inputs.light = theme.light;
  if (!(inputs == last_) || anatomyShown_ == nullptr) {
    last_ = inputs;
    changedAt_ = now;
    renderDraft(textures, theme);
    compositeStale_ = true;
  }
  if (!refined_ && (!patient || now - changedAt_ > kRest_s)) {
    if (!fineStarted_) startFine(textures, theme);
    if (continueFine(textures, !patient)) {
      refined_ = true;
      anatomyShown_ = &fine_;
      compositeStale_ = true;
    }
  }
  const GlFramebuffer* shown = anatomyShown_;
  if (snapshot != nullptr && tool_.loaded()) {
    // The ghost and the arrows belong to the step: nothing else moves them.
    if (compositeStale_ || snapshot->step != compositeStep_ || compositeOf_ != anatomyShown_) {
      composite(*snapshot, theme);
      compositeStep_ = snapshot->step;
      compositeOf_ = anatomyShown_;
      compositeStale_ = false;
    }
    shown = &composite_;
  }
  ImGui::GetWindowDrawList()->AddImage(
      reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(shown->colour())), {area.x, area.y},
      {area.right(), area.bottom()}, {0, 1}, {1, 0});
}

}  // namespace palpate::ui
