#include "imaging/exchange/surface_voxels.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace palpate {
namespace fs = std::filesystem;
namespace {

__extension__ using Int128 = __int128;
using Fixed = Eigen::Matrix<std::int64_t, 3, 1>;

/// A voxel in the units of Fixed.
constexpr std::int64_t kOne = std::int64_t{1} << 20U;
/// Voxels: with kOne, coordinates stay below 2^44 and products of two differences below 2^91.
constexpr double kFarthest = 1 << 24;
/// Rows that triangles may cover in all: some ten seconds. A surface of a million triangles over a
/// volume of 512 x 512 rows covers a few millions.
constexpr std::uint64_t kMaxRows = std::uint64_t{1} << 31U;

int signOf(Int128 value) {
  return value > 0 ? 1 : (value < 0 ? -1 : 0);
}

/// On which side of the edge a → b the row (y, z) lies, as if it stood at (y + ε, z + ε²): never on
/// the edge unless the edge is a point, seen along x. Always computed from the lesser to the
/// greater end, so that both triangles of an edge get the same answer.
int sideOf(const Fixed& a, const Fixed& b, std::int64_t y, std::int64_t z) {
  const auto key = [](const Fixed& p) { return std::array{p[1], p[2]}; };
  if (key(b) < key(a)) return -sideOf(b, a, y, z);
  const std::int64_t dy = b[1] - a[1];
  const std::int64_t dz = b[2] - a[2];
  const Int128 exact = static_cast<Int128>(dy) * (z - a[2]) - static_cast<Int128>(dz) * (y - a[1]);
  if (exact != 0) return signOf(exact);
  return dz != 0 ? signOf(-dz) : signOf(dy);
}

/// Where the plane of the triangle is at a row that it covers, in voxels.
double crossing(const Fixed& a, const Fixed& b, const Fixed& c, std::int64_t y, std::int64_t z) {
  const auto area = [](const Fixed& p, const Fixed& q, std::int64_t ry, std::int64_t rz) {
    return static_cast<double>(static_cast<Int128>(q[1] - p[1]) * (rz - p[2]) -
                               static_cast<Int128>(q[2] - p[2]) * (ry - p[1]));
  };
  const double wa = area(b, c, y, z);
  const double wb = area(c, a, y, z);
  const double wc = area(a, b, y, z);
  const double x = (wa * static_cast<double>(a[0]) + wb * static_cast<double>(b[0]) +
                    wc * static_cast<double>(c[0])) /
                   (wa + wb + wc);
  return x / static_cast<double>(kOne);
}

std::int64_t ceilVoxel(std::int64_t fixed) {
  return (fixed + kOne - 1) >> 20U;  // arithmetic: rounds up also below zero
}

/// Rows of whole voxels, clipped to the volume; empty where last < first.
struct Rows {
  std::int64_t first = 0, last = -1;
};

Rows rowsOf(std::int64_t a, std::int64_t b, std::int64_t c, std::int32_t count) {
  // One to each side: a row stands at (y + ε, z + ε²).
  return {std::max<std::int64_t>(0, ceilVoxel(std::min({a, b, c})) - 1),
          std::min<std::int64_t>(count - 1, ceilVoxel(std::max({a, b, c})))};
}

std::uint64_t countOf(const Rows& rows) {
  return rows.last < rows.first ? 0 : static_cast<std::uint64_t>(rows.last - rows.first + 1);
}

/// Marks where rows enter or leave: a voxel is inside where an odd number of marks is at it or
/// before it in its row.
void markCrossings(const Fixed& a, const Fixed& b, const Fixed& c, const GridGeometry& g,
                   const Rows& ys, const Rows& zs, std::vector<std::uint8_t>& marks) {
  for (std::int64_t k = zs.first; k <= zs.last; ++k) {
    for (std::int64_t j = ys.first; j <= ys.last; ++j) {
      const std::int64_t y = j * kOne;
      const std::int64_t z = k * kOne;
      const int side = sideOf(a, b, y, z);
      if (side == 0 || sideOf(b, c, y, z) != side || sideOf(c, a, y, z) != side) continue;
      const double x = std::ceil(crossing(a, b, c, y, z));
      if (!(x < g.dims[0])) continue;  // NaN too, of a sliver that no row stands in
      const auto i = static_cast<std::int32_t>(std::max(0.0, x));
      marks[g.index(i, static_cast<std::int32_t>(j), static_cast<std::int32_t>(k))] ^= 1U;
    }
  }
}

/// Vertices in voxels; empty where one is too far away.
std::vector<Fixed> fixedVertices(const SurfaceMesh& mesh, const GridGeometry& g) {
  const Eigen::Matrix3d toVoxels =
      (g.spacing * 1e3).cwiseInverse().asDiagonal() * g.X_PV.linear().transpose();
  const Eigen::Vector3d origin_mm = g.X_PV.translation() * 1e3;
  std::vector<Fixed> vertices;
  vertices.reserve(mesh.vertices_mm.size());
  for (const Eigen::Vector3f& p_mm : mesh.vertices_mm) {
    const Eigen::Vector3d p = toVoxels * (p_mm.cast<double>() - origin_mm);
    if (!(p.cwiseAbs().maxCoeff() < kFarthest)) return {};
    vertices.emplace_back(std::llround(p[0] * kOne), std::llround(p[1] * kOne),
                          std::llround(p[2] * kOne));
  }
  return vertices;
}

bool isOutside(const std::vector<Fixed>& vertices, const GridGeometry& g) {
  return std::any_of(vertices.begin(), vertices.end(), [&g](const Fixed& p) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      // The outer faces of the outer voxels.
      if (p[a] < -kOne / 2 - 1) return true;
      if (p[a] > g.dims[static_cast<std::size_t>(a)] * kOne - kOne / 2 + 1) return true;
    }
    return false;
  });
}

/// False where the triangles cover too many rows, or on cancel.
Result<void> markAll(const SurfaceMesh& mesh, const std::vector<Fixed>& vertices,
                     const GridGeometry& g, std::vector<std::uint8_t>& marks, const fs::path& file,
                     const Progress& progress) {
  std::uint64_t covered = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Fixed& a = vertices[mesh.triangles[t][0]];
    const Fixed& b = vertices[mesh.triangles[t][1]];
    const Fixed& c = vertices[mesh.triangles[t][2]];
    const Rows ys = rowsOf(a[1], b[1], c[1], g.dims[1]);
    const Rows zs = rowsOf(a[2], b[2], c[2], g.dims[2]);
    covered += countOf(ys) * countOf(zs);
    if (covered > kMaxRows) {
      return fail(inputRefused("The surface crosses itself more often than any anatomy.")
                      .inFile(file.string())
                      .advise("Remesh the surface, or export it as a label volume."));
    }
    if (t % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelled());
      progress(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()), "Filling");
    }
    markCrossings(a, b, c, g, ys, zs, marks);
  }
  return {};
}

void fillRows(const GridGeometry& g, std::vector<std::uint8_t>& marks) {
  const auto nx = static_cast<std::size_t>(g.dims[0]);
  for (std::size_t row = 0; row < marks.size(); row += nx) {
    std::uint8_t inside = 0;
    for (std::size_t i = row; i < row + nx; ++i) marks[i] = inside ^= marks[i];
  }
}

}  // namespace

std::size_t openEdges(const SurfaceMesh& mesh) {
  std::vector<std::uint64_t> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax(t[c], t[(c + 1) % 3]);
      edges.push_back(std::uint64_t{low} << 32U | high);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (auto at = edges.begin(); at != edges.end();) {
    const auto next = std::find_if(at, edges.end(), [at](std::uint64_t e) { return e != *at; });
    if ((next - at) % 2 != 0) ++open;
    at = next;
  }
  return open;
}

Result<InsideVoxels> voxelsInside(const SurfaceMesh& mesh, const GridGeometry& geometry,
                                  const fs::path& file, const Progress& progress) {
  if (const std::size_t open = openEdges(mesh); open > 0) {
    return fail(inputRefused("The surface is open, so that nothing is inside.")
                    .inFile(file.string())
                    .inField("edges")
                    .butFound(std::to_string(open) + " edges of one triangle only")
                    .wants("every edge shared by two triangles")
                    .advise("Close the holes in the program that made it."));
  }
  const std::vector<Fixed> vertices = fixedVertices(mesh, geometry);
  if (vertices.empty()) {
    return fail(inputRefused("The surface lies far from the case's volume.")
                    .inFile(file.string())
                    .inField("vertices")
                    .wants("patient coordinates (LPS) in millimetres")
                    .advise("Export it in patient coordinates, in millimetres."));
  }
  InsideVoxels inside;
  inside.reachesOut = isOutside(vertices, geometry);
  inside.mask.assign(geometry.voxelCount(), 0);
  if (auto ok = markAll(mesh, vertices, geometry, inside.mask, file, progress); !ok) {
    return fail(ok.error());
  }
  fillRows(geometry, inside.mask);
  if (std::find(inside.mask.begin(), inside.mask.end(), 1) != inside.mask.end()) return inside;
  return fail(inputRefused("The surface holds no voxel of the case's volume.")
                  .inFile(file.string())
                  .inField("vertices")
                  .wants("patient coordinates (LPS) in millimetres, within the volume")
                  .advise("Check that it was made on this scan."));
}

}  // namespace palpate
