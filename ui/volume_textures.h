#pragma once
/// The open case on the graphics card: grey values, labels, their colours, brick maxima.
///
/// A large scan takes longer than a frame to send: volume and labels go slice by slice, a few
/// milliseconds a frame, and of new labels only the slices that differ.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/voxels/label_grid.h"
#include "imaging/volume.h"
#include "ui/gl_objects.h"
#include "ui/model.h"

namespace palpate::ui {

/// Largest value of each brick of `edge` voxels and the voxels that touch it; x fastest. Any
/// thread.
struct BrickMaxima {
  std::array<int, 3> count{0, 0, 0};
  std::vector<float> most;
};
[[nodiscard]] BrickMaxima brickMaxima(const Volume& volume, int edge);

/// One a window; shared by the slice views and the volume rendering. Main thread.
class VolumeTextures {
 public:
  /// Edge of a brick for empty-space skipping, voxels.
  static constexpr int kBrick = 8;

  /// Replaces volume and bricks (of kBrick); labels are dropped. Shown when send() has sent it.
  void setVolume(std::shared_ptr<const Volume> volume, const BrickMaxima& bricks);
  /// Same geometry as the volume, else ignored. send() replaces the slices one by one; the first
  /// labels are shown when all of them are there.
  void setLabels(std::shared_ptr<const LabelGrid> labels);
  void dropLabels();
  /// Sends what is not there yet, a slice at least, until then.
  void send(std::chrono::steady_clock::time_point until);
  [[nodiscard]] bool sending() const noexcept { return volume_ != nullptr || wanted_ != nullptr; }
  void setPalette(const std::vector<LabelRow>& rows);
  void clear();

  [[nodiscard]] bool loaded() const noexcept { return volumeTexture_ && volume_ == nullptr; }
  [[nodiscard]] bool hasLabels() const noexcept { return labelsWhole_; }
  /// Slices of labels sent so far.
  [[nodiscard]] std::size_t labelSlicesSent() const noexcept { return labelSlicesSent_; }
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
  void sendVolumeSlice();
  void sendLabelSlice();
  GlTexture volumeTexture_, labelTexture_, palette_, bricks_;
  std::array<std::uint8_t, 1024> paletteTable_{};
  GridGeometry grid_;
  std::shared_ptr<const Volume> volume_;                    ///< While it is being sent.
  std::shared_ptr<const LabelGrid> wanted_;                 ///< While they are being sent.
  std::vector<std::shared_ptr<const LabelGrid>> labelsOf_;  ///< What each slice shows.
  std::int32_t next_ = 0;                                   ///< Slice to send.
  bool labelsWhole_ = false;
  std::size_t labelSlicesSent_ = 0;
  float valueScale_ = 1.0F;
  std::array<int, 3> brickCount_{0, 0, 0};
  std::uint64_t version_ = 0;
};

}  // namespace palpate::ui
