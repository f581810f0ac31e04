#include "ui/surface_layer.h"

#include <algorithm>

#include "ui/gl_api.h"

namespace palpate::ui {

GlMesh meshOf(const SurfaceChunk& chunk, const Eigen::Vector3d& origin_mm) {
  std::vector<float> interleaved;
  interleaved.reserve(chunk.vertices_mm.size() * 2);
  for (std::size_t v = 0; v + 2 < chunk.vertices_mm.size(); v += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      interleaved.push_back(static_cast<float>(static_cast<double>(chunk.vertices_mm[v + c]) -
                                               origin_mm[static_cast<Eigen::Index>(c)]));
    }
    for (std::size_t c = 0; c < 3; ++c) interleaved.push_back(chunk.normals[v + c]);
  }
  return makeMesh(interleaved, chunk.triangles);
}

void SurfaceLayer::setLabel(std::uint8_t value, const std::vector<SurfaceChunk>& chunks,
                            const Eigen::Vector3d& origin_mm) {
  Label& label = labels_[value];
  label.chunks.clear();
  label.low_mm = Eigen::Vector3d::Constant(1e30);
  label.high_mm = -label.low_mm;
  for (const SurfaceChunk& chunk : chunks) {
    if (chunk.triangles.empty()) continue;
    for (std::size_t v = 0; v + 2 < chunk.vertices_mm.size(); v += 3) {
      const Eigen::Vector3d p =
          Eigen::Map<const Eigen::Vector3f>(&chunk.vertices_mm[v]).cast<double>();
      label.low_mm = label.low_mm.cwiseMin(p);
      label.high_mm = label.high_mm.cwiseMax(p);
    }
    label.chunks.push_back(meshOf(chunk, origin_mm));
  }
  ++version_;
}

void SurfaceLayer::setLoose(const std::vector<std::uint8_t>& values) {
  for (auto& [value, label] : labels_) {
    label.loose = std::find(values.begin(), values.end(), value) != values.end();
  }
  ++version_;
}

void SurfaceLayer::keep(const std::vector<LabelRow>& rows) {
  const auto gone = std::erase_if(labels_, [&rows](const auto& entry) {
    return std::none_of(rows.begin(), rows.end(),
                        [&entry](const LabelRow& row) { return row.value == entry.first; });
  });
  if (gone > 0) ++version_;
}

void SurfaceLayer::clear() {
  labels_.clear();
  ++version_;
}

void SurfaceLayer::setRows(const std::vector<LabelRow>& rows) {
  for (auto& [value, label] : labels_) label.visible = false;
  for (const LabelRow& row : rows) {
    const auto found = labels_.find(row.value);
    if (found == labels_.end()) continue;
    found->second.visible = row.visible;
    found->second.colour = Eigen::Vector3f(static_cast<float>(row.colour[0]) / 255.0F,
                                           static_cast<float>(row.colour[1]) / 255.0F,
                                           static_cast<float>(row.colour[2]) / 255.0F);
  }
  ++version_;
}

void SurfaceLayer::draw(const GlProgram& program) const {
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  for (const auto& [value, label] : labels_) {
    if (!label.visible || label.loose) continue;
    program.set("baseColour", label.colour);
    for (const GlMesh& chunk : label.chunks) drawMesh(chunk);
  }
  glDisable(GL_DEPTH_TEST);
}

std::optional<std::array<Eigen::Vector3d, 2>> SurfaceLayer::bounds_mm() const {
  std::optional<std::array<Eigen::Vector3d, 2>> box;
  for (const auto& [value, label] : labels_) {
    if (label.chunks.empty()) continue;
    if (!box) box = {label.low_mm, label.high_mm};
    box = {(*box)[0].cwiseMin(label.low_mm), (*box)[1].cwiseMax(label.high_mm)};
  }
  return box;
}

std::size_t SurfaceLayer::triangles() const noexcept {
  std::size_t sum = 0;
  for (const auto& [value, label] : labels_) {
    for (const GlMesh& chunk : label.chunks) sum += static_cast<std::size_t>(chunk.indexCount) / 3;
  }
  return sum;
}

}  // namespace palpate::ui
