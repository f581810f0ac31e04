#include "ui/volume_layer.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/units.h"
#include "ui/gl_api.h"

namespace palpate::ui {

std::vector<TransferPoint> transferFor(const std::string& modality,
                                       const std::array<double, 2>& window) {
  if (modality == "CT") {
    // HU. Under 180 nothing: neither skin nor soft tissue shows. Up to 300 spongy bone.
    return {{180.0, {0.60F, 0.38F, 0.28F, 0.0F}},
            {300.0, {0.80F, 0.62F, 0.46F, 0.10F}},
            {450.0, {0.90F, 0.82F, 0.67F, 0.38F}},
            {900.0, {0.94F, 0.90F, 0.80F, 0.70F}},
            {2000.0, {1.0F, 0.98F, 0.94F, 0.90F}}};
  }
  const double low = window[0] - 0.5 * window[1];
  const auto at = [&](double share) { return low + share * window[1]; };
  return {{at(0.35), {0.35F, 0.20F, 0.18F, 0.0F}},
          {at(0.55), {0.70F, 0.52F, 0.45F, 0.06F}},
          {at(0.80), {0.88F, 0.80F, 0.72F, 0.20F}},
          {at(1.10), {1.0F, 0.98F, 0.94F, 0.35F}}};
}

std::vector<std::uint8_t> transferTable(const std::vector<TransferPoint>& points, double low,
                                        double high, int count) {
  std::vector<std::uint8_t> table;
  table.reserve(static_cast<std::size_t>(count) * 4);
  for (int i = 0; i < count; ++i) {
    const double value = low + (high - low) * (i + 0.5) / count;
    std::array<float, 4> c =
        value <= points.front().value ? points.front().rgba : points.back().rgba;
    for (std::size_t p = 0; p + 1 < points.size(); ++p) {
      if (value < points[p].value || value > points[p + 1].value) continue;
      const auto f =
          static_cast<float>((value - points[p].value) / (points[p + 1].value - points[p].value));
      for (std::size_t k = 0; k < 4; ++k) {
        c[k] = points[p].rgba[k] + f * (points[p + 1].rgba[k] - points[p].rgba[k]);
      }
    }
    for (const float channel : c) {
      table.push_back(static_cast<std::uint8_t>(std::lround(255.0F * channel)));
    }
  }
  return table;
}

Result<VolumeLayer> VolumeLayer::load(const std::filesystem::path& shaders) {
  auto program = GlProgram::load(shaders, "fullscreen.vert", "volume.frag");
  if (!program) return fail(program.error());
  VolumeLayer self;
  self.program_ = std::move(*program);
  return self;
}

void VolumeLayer::setTransfer(const std::vector<TransferPoint>& points) {
  low_ = static_cast<float>(points.front().value);
  high_ = static_cast<float>(points.back().value);
  opaqueFrom_ = low_;
  const auto table = transferTable(points, points.front().value, points.back().value, 256);
  unsigned id = 0;
  glGenTextures(1, &id);
  transfer_ = GlTexture(id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, table.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void VolumeLayer::draw(const VolumeTextures& textures, const Camera& camera,
                       const Eigen::Vector3d& origin_mm, int width, int height, int firstRow,
                       int endRow, float stepVoxels, unsigned backdrop) const {
  const GridGeometry& grid = textures.grid();
  // Voxel index to patient millimetres minus the origin.
  Eigen::Matrix4d fromVoxel = Eigen::Matrix4d::Identity();
  fromVoxel.topLeftCorner<3, 3>() =
      grid.X_PV.linear() * (grid.spacing * kMillimetresPerMetre).asDiagonal();
  fromVoxel.topRightCorner<3, 1>() = grid.X_PV.translation() * kMillimetresPerMetre - origin_mm;
  const double aspect = static_cast<double>(width) / std::max(1, height);
  const Eigen::Matrix4d view = camera.view(origin_mm).cast<double>();
  const Eigen::Matrix4d clipFromVoxel = camera.projection(aspect).cast<double>() * view * fromVoxel;
  const Eigen::Vector4d eye =
      fromVoxel.inverse() * (Eigen::Vector4d() << camera.eye_mm() - origin_mm, 1.0).finished();

  program_.use();
  textures.bindVolume(program_, 0, true);
  textures.bindBricks(program_, 1);
  program_.texture("transfer", 2, GL_TEXTURE_2D, transfer_.id());
  program_.texture("backdrop", 3, GL_TEXTURE_2D, backdrop);
  program_.set("transferRange", Eigen::Vector2f(low_, high_));
  program_.set("opaqueFrom", opaqueFrom_);
  program_.set("clipFromVoxel", Eigen::Matrix4f(clipFromVoxel.cast<float>()));
  program_.set("voxelFromClip", Eigen::Matrix4f(clipFromVoxel.inverse().cast<float>()));
  program_.set("eyeVoxel", Eigen::Vector3f(eye.head<3>().cast<float>()));
  // Gradients are covectors: inverse transpose of voxel-to-eye.
  const Eigen::Matrix3d toEye = view.topLeftCorner<3, 3>() * fromVoxel.topLeftCorner<3, 3>();
  program_.set("eyeFromVoxelNormal", Eigen::Matrix3f(toEye.inverse().transpose().cast<float>()));
  program_.set("stepVoxels", stepVoxels);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, firstRow, width, endRow - firstRow);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  drawFullScreen();
  glDepthFunc(GL_LESS);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace palpate::ui
