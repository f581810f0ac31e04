#include "ui/volume_textures.h"

#include <algorithm>

#include "ui/gl_api.h"

namespace palpate::ui {
namespace {

GlTexture texture3D(const std::array<std::int32_t, 3>& dims, int internal, unsigned format,
                    unsigned type, const void* data, int filter) {
  unsigned id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_3D, id);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, internal, dims[0], dims[1], dims[2], 0, format, type, data);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
  for (const unsigned wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    glTexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
  }
  return GlTexture(id);
}

}  // namespace

std::vector<float> brickMaxima(const Volume& volume, int edge, std::array<int, 3>& count) {
  const auto& dims = volume.geometry.dims;
  for (std::size_t a = 0; a < 3; ++a) count[a] = (dims[a] + edge - 1) / edge;
  std::vector<float> most;
  most.reserve(static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
               static_cast<std::size_t>(count[2]));
  // One voxel of rim: a sample between two bricks interpolates across the border.
  for (int bk = 0; bk < count[2]; ++bk) {
    for (int bj = 0; bj < count[1]; ++bj) {
      for (int bi = 0; bi < count[0]; ++bi) {
        double best = -1e30;
        for (int k = std::max(0, bk * edge - 1); k < std::min(dims[2], (bk + 1) * edge + 1); ++k) {
          for (int j = std::max(0, bj * edge - 1); j < std::min(dims[1], (bj + 1) * edge + 1);
               ++j) {
            const std::size_t row = volume.geometry.index(0, j, k);
            const int end = std::min(dims[0], (bi + 1) * edge + 1);
            for (int i = std::max(0, bi * edge - 1); i < end; ++i) {
              best = std::max(best, volume.value(row + static_cast<std::size_t>(i)));
            }
          }
        }
        most.push_back(static_cast<float>(best));
      }
    }
  }
  return most;
}

void VolumeTextures::setVolume(const Volume& volume) {
  clear();
  grid_ = volume.geometry;
  if (volume.type == VoxelType::Int16) {
    valueScale_ = 32767.0F;  // signed normalised
    volume_ = texture3D(grid_.dims, GL_R16_SNORM, GL_RED, GL_SHORT, volume.int16.data(), GL_LINEAR);
  } else {
    valueScale_ = 1.0F;
    volume_ = texture3D(grid_.dims, GL_R32F, GL_RED, GL_FLOAT, volume.float32.data(), GL_LINEAR);
  }
  std::vector<float> most = brickMaxima(volume, kBrick, brickCount_);
  for (float& v : most) v /= valueScale_;
  bricks_ = texture3D({brickCount_[0], brickCount_[1], brickCount_[2]}, GL_R32F, GL_RED, GL_FLOAT,
                      most.data(), GL_NEAREST);
  ++version_;
}

void VolumeTextures::setLabels(const LabelGrid& labels) {
  if (labels.geometry.dims != grid_.dims) return;
  labels_ = texture3D(grid_.dims, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, labels.labels.data(),
                      GL_NEAREST);
  ++version_;
}

void VolumeTextures::dropLabels() {
  labels_ = GlTexture();
  ++version_;
}

void VolumeTextures::setPalette(const std::vector<LabelRow>& rows) {
  std::array<std::uint8_t, 1024> table{};
  for (const LabelRow& row : rows) {
    const std::size_t at = std::size_t{row.value} * 4;
    for (std::size_t c = 0; c < 3; ++c) table[at + c] = row.colour[c];
    table[at + 3] = row.visible ? 255 : 0;
  }
  unsigned id = palette_.id();
  if (id == 0) {
    glGenTextures(1, &id);
    palette_ = GlTexture(id);
  }
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 256, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, table.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  ++version_;
}

void VolumeTextures::clear() {
  volume_ = GlTexture();
  labels_ = GlTexture();
  bricks_ = GlTexture();
  ++version_;
}

void VolumeTextures::bindVolume(const GlProgram& program, int unit, bool interpolate) const {
  program.texture("volume", unit, GL_TEXTURE_3D, volume_.id());
  const int filter = interpolate ? GL_LINEAR : GL_NEAREST;
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
  program.set("valueScale", valueScale_);
  program.set("dims",
              Eigen::Vector3f(static_cast<float>(grid_.dims[0]), static_cast<float>(grid_.dims[1]),
                              static_cast<float>(grid_.dims[2])));
}

void VolumeTextures::bindBricks(const GlProgram& program, int unit) const {
  program.texture("bricks", unit, GL_TEXTURE_3D, bricks_.id());
  program.set("brickCount", Eigen::Vector3f(static_cast<float>(brickCount_[0]),
                                            static_cast<float>(brickCount_[1]),
                                            static_cast<float>(brickCount_[2])));
}

void VolumeTextures::bindLabels(const GlProgram& program, int labelUnit, int paletteUnit) const {
  program.set("hasLabels", hasLabels() && palette_ ? 1 : 0);
  program.texture("labels", labelUnit, GL_TEXTURE_3D, labels_.id());
  program.texture("palette", paletteUnit, GL_TEXTURE_2D, palette_.id());
}

}  // namespace palpate::ui
