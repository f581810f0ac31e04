#include "ui/surface_layer.h"

#include <algorithm>
#include <utility>

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

void SurfaceLayer::setLabel(std::uint8_t value, SharedChunks chunks,
                            const Eigen::Vector3d& origin_mm) {
  Label& label = labels_[value];
  label.sent.clear();
  label.next = 0;
  label.origin_mm = origin_mm;
  label.coming = std::move(chunks);
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e30F), high = -low;
  for (const SurfaceChunk& chunk : *label.coming) {
    for (std::size_t v = 0; v + 2 < chunk.vertices_mm.size(); v += 3) {
      const Eigen::Map<const Eigen::Vector3f> p(&chunk.vertices_mm[v]);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  label.low_mm = low.cast<double>();
  label.high_mm = high.cast<double>();
}

bool SurfaceLayer::sending() const noexcept {
  return std::any_of(labels_.begin(), labels_.end(),
                     [](const auto& entry) { return entry.second.coming != nullptr; });
}

void SurfaceLayer::send(std::chrono::steady_clock::time_point until) {
  for (auto& [value, label] : labels_) {
    if (label.coming == nullptr) continue;
    while (label.next < label.coming->size()) {
      const SurfaceChunk& chunk = (*label.coming)[label.next++];
      if (!chunk.triangles.empty()) label.sent.push_back(meshOf(chunk, label.origin_mm));
      if (std::chrono::steady_clock::now() >= until) break;
    }
    if (label.next < label.coming->size()) return;
    label.chunks = std::move(label.sent);
    label.sent.clear();
    label.coming.reset();
    ++version_;
    if (std::chrono::steady_clock::now() >= until) return;
  }
}

void SurfaceLayer::setLoose(const std::vector<std::uint8_t>& values) {
  for (auto& [value, label] : labels_) {
    const bool loose = std::find(values.begin(), values.end(), value) != values.end();
    if (loose != label.loose) ++version_;
    label.loose = loose;
  }
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
  for (auto& [value, label] : labels_) {
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const LabelRow& r) { return r.value == value; });
    const bool visible = row != rows.end() && row->visible;
    Eigen::Vector3f colour = label.colour;
    if (row != rows.end()) {
      for (int c = 0; c < 3; ++c) {
        colour[c] = static_cast<float>(row->colour[static_cast<std::size_t>(c)]) / 255.0F;
      }
    }
    if (visible != label.visible || colour != label.colour) ++version_;
    label.visible = visible;
    label.colour = colour;
  }
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
    if (label.empty()) continue;
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
