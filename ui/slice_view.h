#pragma once
/// One slice plane: the picture (re-rendered only when its inputs change) and what lies over it.

#include <imgui.h>

#include <array>
#include <functional>
#include <vector>

#include "core/simulation/snapshot.h"
#include "ui/gl_objects.h"
#include "ui/slice_geometry.h"
#include "ui/theme.h"
#include "ui/view_state.h"
#include "ui/volume_textures.h"

namespace palpate::ui {

struct SliceOverlay;

/// The instrument's mesh where it is now, P metres; for its outline in the slices.
struct PlacedMesh {
  const std::vector<Eigen::Vector3d>* vertices_T = nullptr;
  const std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;
  Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
};

/// Line segments where a mesh crosses the plane `voxel[axis] == slice`; continuous voxel indices.
[[nodiscard]] std::vector<std::array<Eigen::Vector3d, 2>> crossSection(const PlacedMesh& mesh,
                                                                       const GridGeometry& grid,
                                                                       int axis, double slice);

/// What a tool does in a slice: `takes` reads the mouse, right after the view's button, and says
/// whether the left one is the tool's; `draws` shows what was picked or drawn.
struct SliceTool {
  std::function<bool(const Rect&, const SlicePlane&, const SliceFit&, double slice)> takes;
  std::function<void(const SliceOverlay&)> draws;
};

class SliceView {
 public:
  explicit SliceView(View view) noexcept : view_(view) {}

  /// Draws into `area` and reads the mouse over it: wheel scrolls, left sets the crosshair, right
  /// is window/level, middle pans, ctrl + wheel zooms. True when it was double-clicked.
  bool draw(const Rect& area, const VolumeTextures& textures, const GlProgram& program,
            ViewState& state, const PlacedMesh& tool, const Snapshot* snapshot,
            const SliceTool& edit, const Theme& theme, ImFont* small, float scale);

  [[nodiscard]] int rendered() const noexcept { return rendered_; }  ///< Pictures made so far.

 private:
  struct Inputs {
    std::uint64_t textures = 0;
    int width = 0, height = 0;
    double slice = 0, zoom = 1;
    Eigen::Vector2d pan{0, 0};
    std::array<double, 2> window{0, 0};
    std::array<double, 2> preview{1, 0};
    float opacity = 0, edge = 0;
    bool interpolate = true;
    bool operator==(const Inputs&) const = default;
  };
  void render(const Inputs& inputs, const VolumeTextures& textures, const GlProgram& program,
              const SlicePlane& plane, const SliceFit& fit, const Theme& theme);
  bool interact(const Rect& area, const VolumeTextures& textures, ViewState& state,
                const SlicePlane& plane, const SliceFit& fit, bool taken, float scale);

  View view_;
  Inputs last_;
  GlFramebuffer picture_;
  int rendered_ = 0;
};

}  // namespace palpate::ui
