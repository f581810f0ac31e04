#include "imaging/exchange/surface_read.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>

#include "imaging/exchange/ply_surface.h"
#include "imaging/exchange/surface_text.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kStlHeader = 84;    ///< 80 bytes of text, and the number of triangles.
constexpr std::size_t kStlTriangle = 50;  ///< Normal, three corners, two bytes of attributes.

std::optional<std::string> contentOf(const fs::path& file) {
  std::error_code ec;
  const auto size = fs::file_size(file, ec);
  std::ifstream in(file, std::ios::binary);
  if (ec || !in) return std::nullopt;
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) return std::nullopt;
  return bytes;
}

std::optional<SurfaceMesh> parseBinaryStl(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() < kStlHeader) return std::nullopt;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  if ((bytes.size() - kStlHeader) / kStlTriangle < count || count > 0xFFFFFFFFU / 3)
    return std::nullopt;
  SurfaceMesh mesh;
  for (std::uint32_t t = 0; t < count; ++t) {
    const char* corners = bytes.data() + kStlHeader + t * kStlTriangle + 12;
    for (std::size_t c = 0; c < 3; ++c) {
      Eigen::Vector3f p;
      std::memcpy(p.data(), corners + 12 * c, 12);
      mesh.vertices_mm.push_back(p);
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

std::optional<Eigen::Vector3f> takePoint(std::string_view& text) {
  Eigen::Vector3f p;
  for (float& coordinate : p.reshaped()) {
    const auto value = numberFrom<double>(takeWord(text));
    if (!value) return std::nullopt;
    coordinate = static_cast<float>(*value);
  }
  return p;
}

std::optional<SurfaceMesh> parseTextStl(std::string_view text) {
  SurfaceMesh mesh;
  bool ended = false;
  while (!text.empty()) {
    std::string_view line = takeLine(text);
    const std::string_view key = takeWord(line);
    if (key == "endsolid") ended = true;
    if (key != "vertex") continue;
    const auto p = takePoint(line);
    if (!p) return std::nullopt;
    mesh.vertices_mm.push_back(*p);
  }
  if (!ended || mesh.vertices_mm.size() % 3 != 0) return std::nullopt;
  for (std::uint32_t v = 0; v < mesh.vertices_mm.size(); v += 3) {
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

/// Text files begin with "solid"; so do some binary ones, whose size tells.
std::optional<SurfaceMesh> parseStl(std::string_view bytes) {
  if (bytes.starts_with("solid") && bytes.substr(0, 1024).find("facet") != std::string_view::npos) {
    return parseTextStl(bytes);
  }
  return parseBinaryStl(bytes);
}

/// A corner "7", "7/1", "7//3" or "-1" (the last vertex so far) as an index from 0.
std::optional<std::uint32_t> objCorner(std::string_view word, std::size_t vertices) {
  const auto number = numberFrom<std::int64_t>(word.substr(0, word.find('/')));
  if (!number || *number == 0) return std::nullopt;
  const std::int64_t index =
      *number > 0 ? *number - 1 : static_cast<std::int64_t>(vertices) + *number;
  if (index < 0 || index >= 0xFFFFFFFF) return std::nullopt;
  return static_cast<std::uint32_t>(index);
}

bool takeObjFace(std::string_view line, SurfaceMesh& mesh) {
  std::array<std::uint32_t, 3> fan{};
  std::size_t count = 0;
  for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
    const auto corner = objCorner(word, mesh.vertices_mm.size());
    if (!corner) return false;
    fan[std::min<std::size_t>(count, 2)] = *corner;
    if (++count < 3) continue;
    mesh.triangles.push_back(fan);
    fan[1] = fan[2];
  }
  return count >= 3;
}

std::optional<SurfaceMesh> parseObj(std::string_view text) {
  SurfaceMesh mesh;
  while (!text.empty()) {
    std::string_view line = takeLine(text);
    const std::string_view key = takeWord(line);
    if (key == "f" && !takeObjFace(line, mesh)) return std::nullopt;
    if (key != "v") continue;
    const auto p = takePoint(line);
    if (!p) return std::nullopt;
    mesh.vertices_mm.push_back(*p);
  }
  return mesh;
}

std::optional<SurfaceMesh> parse(std::string_view bytes, ExchangeFormat format) {
  if (format == ExchangeFormat::Stl) return parseStl(bytes);
  if (format == ExchangeFormat::Ply) return parsePly(bytes);
  return parseObj(bytes);
}

bool isUsable(const SurfaceMesh& mesh) {
  const std::size_t count = mesh.vertices_mm.size();
  const bool finite = std::all_of(mesh.vertices_mm.begin(), mesh.vertices_mm.end(),
                                  [](const Eigen::Vector3f& p) { return p.allFinite(); });
  return finite &&
         std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [count](const auto& t) {
           return std::all_of(t.begin(), t.end(), [count](std::uint32_t c) { return c < count; });
         });
}

}  // namespace

Result<SurfaceMesh> readSurface(const fs::path& file, ExchangeFormat format) {
  const auto bytes = contentOf(file);
  auto mesh = bytes ? parse(*bytes, format) : std::nullopt;
  if (!mesh || !isUsable(*mesh)) {
    return fail(inputRefused(std::string("The ") + exchangeFormatName(format) +
                             " file is damaged or cut short.")
                    .inFile(file.string())
                    .advise("Copy it again from where it came, or export it again."));
  }
  // 3D Slicer states the space within the header or the first comments.
  if (std::string_view(*bytes).substr(0, 1024).find("SPACE=RAS") != std::string_view::npos) {
    for (Eigen::Vector3f& p : mesh->vertices_mm) p.head<2>() *= -1.0F;
  }
  weld(*mesh);
  if (mesh->triangles.empty()) {
    return fail(inputRefused("The file holds no triangles.")
                    .inFile(file.string())
                    .wants("a closed surface")
                    .advise("Export the surface again, as triangles."));
  }
  return std::move(*mesh);
}

}  // namespace palpate
