#pragma once
/// The 3D view: anatomy (surface or volume rendering) kept as a picture until its inputs change,
/// and over it, every frame of the simulation, the instrument, contacts and forces.
///
/// While the camera moves the anatomy is a draft (no occlusion, or a third of the resolution); when
/// it rests the full picture is made in bands of a few milliseconds and then shown whole.

#include <imgui.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "core/scene/instrument.h"
#include "ui/body_layer.h"
#include "ui/contact_impostors.h"
#include "ui/gl_objects.h"
#include "ui/layout.h"
#include "ui/surface_layer.h"
#include "ui/theme.h"
#include "ui/tool_layer.h"
#include "ui/view_state.h"
#include "ui/volume_layer.h"
#include "ui/volume_textures.h"

namespace palpate::ui {

class SceneView {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SceneView>> load(
      const std::filesystem::path& shaders);

  [[nodiscard]] SurfaceLayer& surface() noexcept { return surface_; }
  [[nodiscard]] BodyLayer& bodies() noexcept { return bodies_; }
  [[nodiscard]] ToolLayer& tool() noexcept { return tool_; }
  [[nodiscard]] VolumeLayer& volume() noexcept { return volume_; }
  void setOrigin(const Eigen::Vector3d& origin_mm) { origin_mm_ = origin_mm; }
  [[nodiscard]] const Eigen::Vector3d& origin_mm() const noexcept { return origin_mm_; }

  /// Makes the picture for `area` and puts it there. `now`: seconds, monotonic. `patient`: false
  /// makes the full picture at once (screenshots).
  void draw(const Rect& area, const VolumeTextures& textures, const ViewState& state,
            const Snapshot* snapshot, const Theme& theme, double now, bool patient);

  /// True while a better picture is still being made: the window should not sleep.
  [[nodiscard]] bool refining() const noexcept { return !refined_; }
  [[nodiscard]] int rendered() const noexcept { return rendered_; }  ///< Anatomy pictures so far.

 private:
  struct Inputs {
    Camera camera;
    int width = 0, height = 0;
    std::uint64_t surface = 0, textures = 0;
    bool volume = false, light = false;
    bool operator==(const Inputs&) const = default;
  };
  void renderDraft(const VolumeTextures& textures, const Theme& theme);
  void startFine(const VolumeTextures& textures, const Theme& theme);
  /// One band; true when the picture is whole.
  bool continueFine(const VolumeTextures& textures, bool all);
  void drawBackdrop(const GlFramebuffer& target, const Theme& theme) const;
  void drawSurface(const GlFramebuffer& target) const;
  void composite(const Snapshot& snapshot, const Theme& theme);

  GlProgram backdrop_, anatomy_, occlusion_;
  SurfaceLayer surface_;
  BodyLayer bodies_;
  ToolLayer tool_;
  VolumeLayer volume_;
  ContactImpostors contacts_;
  Eigen::Vector3d origin_mm_ = Eigen::Vector3d::Zero();
  Inputs last_;
  GlFramebuffer draft_, source_, fine_, composite_;
  const GlFramebuffer* anatomyShown_ = nullptr;
  double changedAt_ = -1.0;
  bool refined_ = true, fineStarted_ = false;
  int fineRow_ = 0, bandRows_ = 32;
  int draftDivisor_ = 3;
  int rendered_ = 0;
  std::uint64_t compositeStep_ = 0;
  const GlFramebuffer* compositeOf_ = nullptr;
  bool compositeStale_ = true;
};

}  // namespace palpate::ui
