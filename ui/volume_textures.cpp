#include "ui/volume_textures.h"

#include <algorithm>
#include <utility>

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

void sendSlice(const GlTexture& texture, const std::array<std::int32_t, 3>& dims,
               std::int32_t slice, unsigned format, unsigned type, const void* data) {
  glBindTexture(GL_TEXTURE_3D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, slice, dims[0], dims[1], 1, format, type, data);
}

}  // namespace

BrickMaxima brickMaxima(const Volume& volume, int edge) {
  const auto& dims = volume.geometry.dims;
  BrickMaxima bricks;
  for (std::size_t a = 0; a < 3; ++a) bricks.count[a] = (dims[a] + edge - 1) / edge;
  const auto& count = bricks.count;
  bricks.most.reserve(static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
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
        bricks.most.push_back(static_cast<float>(best));
      }
    }
  }
  return bricks;
}

void VolumeTextures::setVolume(std::shared_ptr<const Volume> volume, const BrickMaxima& bricks) {
  clear();
  grid_ = volume->geometry;
  const bool int16 = volume->type == VoxelType::Int16;
  valueScale_ = int16 ? 32767.0F : 1.0F;  // int16: signed normalised
  volumeTexture_ = texture3D(grid_.dims, int16 ? GL_R16_SNORM : GL_R32F, GL_RED,
                             int16 ? GL_SHORT : GL_FLOAT, nullptr, GL_LINEAR);
  std::vector<float> most = bricks.most;
  for (float& v : most) v /= valueScale_;
  brickCount_ = bricks.count;
  bricks_ = texture3D({brickCount_[0], brickCount_[1], brickCount_[2]}, GL_R32F, GL_RED, GL_FLOAT,
                      most.data(), GL_NEAREST);
  volume_ = std::move(volume);
  ++version_;
}

void VolumeTextures::setLabels(std::shared_ptr<const LabelGrid> labels) {
  if (labels->geometry.dims != grid_.dims) return;
  if (!labelTexture_) {
    labelTexture_ =
        texture3D(grid_.dims, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, nullptr, GL_NEAREST);
    labelsOf_.assign(static_cast<std::size_t>(grid_.dims[2]), nullptr);
  }
  wanted_ = std::move(labels);
  if (volume_ == nullptr) next_ = 0;
}

void VolumeTextures::dropLabels() {
  if (!labelTexture_) return;
  labelTexture_ = GlTexture();
  labelsOf_.clear();
  wanted_.reset();
  labelsWhole_ = false;
  ++version_;
}

void VolumeTextures::send(std::chrono::steady_clock::time_point until) {
  while (sending()) {
    if (volume_ != nullptr) {
      sendVolumeSlice();
    } else {
      sendLabelSlice();
    }
    if (std::chrono::steady_clock::now() >= until) return;
  }
}

void VolumeTextures::sendVolumeSlice() {
  const bool int16 = volume_->type == VoxelType::Int16;
  const std::size_t from = grid_.index(0, 0, next_);
  sendSlice(volumeTexture_, grid_.dims, next_, GL_RED, int16 ? GL_SHORT : GL_FLOAT,
            int16 ? static_cast<const void*>(&volume_->int16[from])
                  : static_cast<const void*>(&volume_->float32[from]));
  if (++next_ < grid_.dims[2]) return;
  volume_.reset();
  next_ = 0;
  ++version_;
}

void VolumeTextures::sendLabelSlice() {
  const std::size_t from = grid_.index(0, 0, next_);
  const std::size_t size = grid_.index(0, 0, 1);
  std::shared_ptr<const LabelGrid>& shown = labelsOf_[static_cast<std::size_t>(next_)];
  const std::uint8_t* voxels = &wanted_->labels[from];
  if (shown == nullptr ||
      (shown != wanted_ && !std::equal(voxels, voxels + size, &shown->labels[from]))) {
    sendSlice(labelTexture_, grid_.dims, next_, GL_RED_INTEGER, GL_UNSIGNED_BYTE, voxels);
    ++labelSlicesSent_;
    if (labelsWhole_) ++version_;
  }
  shown = wanted_;
  if (++next_ < grid_.dims[2]) return;
  wanted_.reset();
  next_ = 0;
  if (!labelsWhole_) ++version_;
  labelsWhole_ = true;
}

void VolumeTextures::setPalette(const std::vector<LabelRow>& rows) {
  std::array<std::uint8_t, 1024> table{};
  for (const LabelRow& row : rows) {
    const std::size_t at = std::size_t{row.value} * 4;
    for (std::size_t c = 0; c < 3; ++c) table[at + c] = row.colour[c];
    table[at + 3] = row.visible ? 255 : 0;
  }
  if (palette_ && table == paletteTable_) return;
  paletteTable_ = table;
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
  dropLabels();
  volumeTexture_ = GlTexture();
  bricks_ = GlTexture();
  volume_.reset();
  next_ = 0;
  ++version_;
}

void VolumeTextures::bindVolume(const GlProgram& program, int unit, bool interpolate) const {
  program.texture("volume", unit, GL_TEXTURE_3D, volumeTexture_.id());
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
  program.texture("labels", labelUnit, GL_TEXTURE_3D, labelTexture_.id());
  program.texture("palette", paletteUnit, GL_TEXTURE_2D, palette_.id());
}

}  // namespace palpate::ui
