#pragma once
/// The volume-rendered view: rays through the grey values, in horizontal bands, so that a slow
/// machine draws a full picture over several frames without ever holding one up.

#include <filesystem>
#include <string>
#include <vector>

#include "ui/camera.h"
#include "ui/gl_objects.h"
#include "ui/volume_textures.h"

namespace palpate::ui {

/// Opacity (per voxel step) and colour over values; linear between points.
struct TransferPoint {
  double value = 0;
  std::array<float, 4> rgba{};
};
/// CT: bone (soft tissue stays transparent); else bright tissue from the window's range.
[[nodiscard]] std::vector<TransferPoint> transferFor(const std::string& modality,
                                                     const std::array<double, 2>& window);
/// `count` RGBA entries (8 bit) evenly over [low, high].
[[nodiscard]] std::vector<std::uint8_t> transferTable(const std::vector<TransferPoint>& points,
                                                      double low, double high, int count);

class VolumeLayer {
 public:
  [[nodiscard]] static Result<VolumeLayer> load(const std::filesystem::path& shaders);
  void setTransfer(const std::vector<TransferPoint>& points);

  /// Draws rows [firstRow, endRow) of the bound framebuffer of that size. `backdrop`: colour
  /// texture of what is behind, same size.
  void draw(const VolumeTextures& textures, const Camera& camera, const Eigen::Vector3d& origin_mm,
            int width, int height, int firstRow, int endRow, float stepVoxels,
            unsigned backdrop) const;

 private:
  GlProgram program_;
  GlTexture transfer_;
  float low_ = 0.0F, high_ = 1.0F, opaqueFrom_ = 0.0F;
};

}  // namespace palpate::ui
