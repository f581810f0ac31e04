#pragma once
/// The whole window: header, panel, views, strip, cards, shortcuts. app/ owns one, gives it the
/// case's data when they change and a Model every frame, and carries out the actions.
///
/// Main thread, OpenGL context current; destroyed before the Window.

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/scene/instrument.h"
#include "core/voxels/label_grid.h"
#include "imaging/surface.h"
#include "imaging/volume.h"
#include "ui/actions.h"
#include "ui/panels.h"
#include "ui/scene_view.h"
#include "ui/slice_view.h"
#include "ui/view_state.h"
#include "ui/volume_textures.h"
#include "ui/window.h"

namespace palpate::ui {

/// What showing a volume needs and takes long to find on a large one.
struct VolumeLook {
  std::array<double, 2> window{0, 1};
  BrickMaxima bricks;
};
/// Any thread.
[[nodiscard]] VolumeLook lookOf(const Volume& volume);

class Workspace {
 public:
  /// Compiles the shaders; refuses a folder without them.
  [[nodiscard]] static Result<std::unique_ptr<Workspace>> load(
      const std::filesystem::path& shaders);

  /// Shared while it is on its way to the graphics card, some frames.
  void showVolume(std::shared_ptr<const Volume> volume, const VolumeLook& look);
  /// Null: none. Kept until it is replaced, to pick in the 3D view.
  void showLabels(std::shared_ptr<const LabelGrid> labels);
  /// How the labels would be, until showLabels(): tools still work on those that are.
  void showPreview(std::shared_ptr<const LabelGrid> labels);
  /// The scene's loose bodies; their labels are no longer drawn as anatomy. Empty: none.
  void showBodies(const std::vector<BodySurface>& bodies);
  void showRows(const std::vector<LabelRow>& rows);
  void showSurface(std::uint8_t label, SharedChunks chunks);
  void clearSurfaces();
  /// Surfaces of labels that are not in `rows` go.
  void keepSurfaces(const std::vector<LabelRow>& rows);
  /// Puts the camera on all surfaces, unless it was moved since the volume was shown.
  void frameSurfaces();
  void showInstrument(const Instrument& instrument);
  void clearCase();

  /// Draws a frame (between beginFrame and endFrame). `now`: seconds, monotonic; `patient` false:
  /// every picture complete at once.
  [[nodiscard]] Actions draw(Window& window, const Model& model, double now, bool patient);

  /// A picture is still being made or a key moves something: draw again soon.
  [[nodiscard]] bool busy() const {
    return sending() || scene_->refining() || segment_.wantedKey != segment_.sentKey;
  }
  /// What was to be shown is still on its way to the graphics card.
  [[nodiscard]] bool sending() const { return textures_.sending() || scene_->surface().sending(); }
  /// What the Segment panel is set to; a new case or a refused step changes it.
  [[nodiscard]] SegmentPanelState& segment() noexcept { return segment_; }
  [[nodiscard]] ViewState& views() noexcept { return state_; }
  [[nodiscard]] const std::map<std::string, Rect>& items() const noexcept { return items_; }
  [[nodiscard]] const Layout& layout() const noexcept { return layout_; }
  /// Pictures of anatomy and slices made so far; does not grow while nothing changes.
  [[nodiscard]] int picturesMade() const;
  /// Centres the 3D view and the slices on a point of the patient, metres.
  void centreOn(const Eigen::Vector3d& p_P);

 private:
  Workspace()
      : slices_{SliceView(View::Axial), SliceView(View::Coronal), SliceView(View::Sagittal)} {}
  void needCharacters(Window& window, const Model& model) const;
  void readKeys(Window& window, const Model& model, Actions& actions);
  void moveByKeys(const Window& window, const Model& model, Actions& actions) const;
  void drawPanel(const Painter& paint, const Model& model, double now);
  [[nodiscard]] SliceTool toolFor(const Painter& paint, const Model& model, View view);
  [[nodiscard]] std::vector<std::uint8_t> hiddenLabels(const Model& model) const;
  /// Of the label that the tools work on; 0: none.
  [[nodiscard]] std::uint8_t chosenValue(const Model& model) const;
  void drawViews(const Painter& paint, const Model& model, bool shift, double now, bool patient);
  void drawScene(const Painter& paint, const Rect& area, const Model& model, bool shift, double now,
                 bool patient);
  void drawEnlarge(const Painter& paint, View view);
  void drawSceneTools(const Painter& paint, const Rect& area, const Model& model);
  void drawEmptyScene(const Painter& paint, const Rect& area, const Model& model) const;
  [[nodiscard]] static const Snapshot* shownSnapshot(const Model& model);
  [[nodiscard]] PlacedMesh placedTool(const Model& model) const;
  void fill(std::optional<View> view) { state_.filled = view; }
  void send(bool all);

  VolumeTextures textures_;
  std::vector<std::uint8_t> loose_;  ///< Labels of loose bodies.
  std::unique_ptr<SceneView> scene_;
  std::array<SliceView, 3> slices_;
  GlProgram sliceProgram_;
  ViewState state_;
  Layout layout_;
  std::shared_ptr<const LabelGrid> labels_, seen_;  ///< As they are, and as they are drawn.
  LibraryPanelState library_;
  SegmentPanelState segment_;
  ExchangePanelState exchange_;
  TriangleMesh instrument_;
  Camera startCamera_;
  bool spaceHolds_ = false, armHeld_ = false, gripped_ = false, help_ = false;
  std::string modality_;
  std::uint64_t followedStep_ = 0;
  std::map<std::string, Rect> items_;
};

}  // namespace palpate::ui
