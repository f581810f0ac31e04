#pragma once
/// The open case on the graphics card: grey values, labels, their colours, brick maxima.

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxels/label_grid.h"
#include "imaging/volume.h"
#include "ui/gl_objects.h"
#include "ui/model.h"

namespace palpate::ui {

/// One a window; shared by the slice views and the volume rendering. Main thread.
class VolumeTextures {
 public:
  /// Edge of a brick for empty-space skipping, voxels.
  static constexpr int kBrick = 8;

  /// Replaces volume and bricks; labels are dropped.
  void setVolume(const Volume& volume);
  /// Same geometry as the volume, else ignored.
  void setLabels(const LabelGrid& labels);
  void dropLabels();
  void setPalette(const std::vector<LabelRow>& rows);
  void clear();

  [[nodiscard]] bool loaded() const noexcept { return static_cast<bool>(volume_); }
  [[nodiscard]] bool hasLabels() const noexcept { return static_cast<bool>(labels_); }
  [[nodiscard]] const GridGeometry& grid() const noexcept { return grid_; }
  /// Stored 0..1 (or −1..1) times this gives the volume's values.
  [[nodiscard]] float valueScale() const noexcept { return valueScale_; }
  [[nodiscard]] std::array<int, 3> brickCount() const noexcept { return brickCount_; }
  /// Counts every change; views compare it to know that they are stale.
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }

  void bindVolume(const GlProgram& program, int unit, bool interpolate) const;
  void bindBricks(const GlProgram& program, int unit) const;
  void bindLabels(const GlProgram& program, int labelUnit, int paletteUnit) const;

 private:
  GlTexture volume_, labels_, palette_, bricks_;
  GridGeometry grid_;
  float valueScale_ = 1.0F;
  std::array<int, 3> brickCount_{0, 0, 0};
  std::uint64_t version_ = 0;
};

/// Largest value of each brick of `edge` voxels and the voxels that touch it; x fastest.
[[nodiscard]] std::vector<float> brickMaxima(const Volume& volume, int edge,
                                             std::array<int, 3>& count);

}  // namespace palpate::ui
