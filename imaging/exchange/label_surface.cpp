#include "imaging/exchange/label_surface.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "imaging/surface.h"

namespace palpate {
namespace {

using Bits = std::array<std::uint32_t, 3>;

struct BitsHash {
  std::size_t operator()(const Bits& b) const noexcept {
    std::uint64_t h = 0;
    // Odd constants of splitmix64 and of the golden ratio: neighbouring floats fall far apart.
    for (const std::uint32_t word : b) {
      h = (h ^ word) * 0xBF58476D1CE4E5B9U;
      h ^= h >> 29U;
    }
    return static_cast<std::size_t>(h * 0x9E3779B97F4A7C15U);
  }
};

Bits bitsOf(const Eigen::Vector3f& p) {
  // Adding zero makes -0 the same as 0.
  return {std::bit_cast<std::uint32_t>(p[0] + 0.0F), std::bit_cast<std::uint32_t>(p[1] + 0.0F),
          std::bit_cast<std::uint32_t>(p[2] + 0.0F)};
}

void append(const SurfaceChunk& chunk, SurfaceMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  for (std::size_t v = 0; v < chunk.vertices_mm.size(); v += 3) {
    mesh.vertices_mm.emplace_back(chunk.vertices_mm[v], chunk.vertices_mm[v + 1],
                                  chunk.vertices_mm[v + 2]);
    mesh.normals.emplace_back(chunk.normals[v], chunk.normals[v + 1], chunk.normals[v + 2]);
  }
  for (std::size_t t = 0; t < chunk.triangles.size(); t += 3) {
    mesh.triangles.push_back({first + chunk.triangles[t], first + chunk.triangles[t + 1],
                              first + chunk.triangles[t + 2]});
  }
}

}  // namespace

void weld(SurfaceMesh& mesh) {
  std::unordered_map<Bits, std::uint32_t, BitsHash> known;
  known.reserve(mesh.vertices_mm.size());
  std::vector<std::uint32_t> now(mesh.vertices_mm.size());
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < now.size(); ++v) {
    const auto [at, isNew] = known.emplace(bitsOf(mesh.vertices_mm[v]), kept);
    now[v] = at->second;
    if (!isNew) continue;
    mesh.vertices_mm[kept] = mesh.vertices_mm[v];
    if (!mesh.normals.empty()) mesh.normals[kept] = mesh.normals[v];
    ++kept;
  }
  mesh.vertices_mm.resize(kept);
  if (!mesh.normals.empty()) mesh.normals.resize(kept);
  for (auto& t : mesh.triangles) t = {now[t[0]], now[t[1]], now[t[2]]};
  std::erase_if(mesh.triangles, [](const std::array<std::uint32_t, 3>& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });
}

Result<SurfaceMesh> labelSurface(const LabelGrid& labels, std::uint8_t value,
                                 const Progress& progress) {
  auto chunks = meshLabel(labels, value, 1, progress);
  if (!chunks) return fail(chunks.error());
  SurfaceMesh mesh;
  for (const SurfaceChunk& chunk : *chunks) append(chunk, mesh);
  weld(mesh);
  if (!mesh.triangles.empty()) return mesh;
  const bool any =
      std::find(labels.labels.begin(), labels.labels.end(), value) != labels.labels.end();
  return fail(
      inputRefused(any ? "The label is too thin to have a surface." : "The label holds no voxels.")
          .inField("label")
          .advise("Export it as a volume (.seg.nrrd or .dcm), or segment again."));
}

}  // namespace palpate
