/// Surfaces: written, read back, filled; and files that are wrong in one thing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "imaging/exchange/label_surface.h"
#include "imaging/exchange/surface_read.h"
#include "imaging/exchange/surface_voxels.h"
#include "imaging/exchange/surface_write.h"
#include "tests/imaging/exchange/exchange_samples.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::expectRefusal;
using test::TestFolder;

constexpr unsigned kSeeds = 4;

/// Balls that overlap, some of them hollow: what anatomy looks like to a surface.
LabelGrid blobs(std::mt19937& random) {
  LabelGrid grid;
  grid.geometry = test::randomGeometry(random, 14, 20);
  grid.geometry.spacing = Eigen::Vector3d(0.5, 0.7, 1.1) * 1e-3;
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto& dims = grid.geometry.dims;
  for (int ball = 0; ball < 5; ++ball) {
    const Eigen::Vector3d centre(unit(random) * dims[0], unit(random) * dims[1],
                                 unit(random) * dims[2]);
    const double radius = 4.0 + 6.0 * unit(random);
    const bool hollow = ball % 2 == 1;
    for (std::int32_t k = 0; k < dims[2]; ++k)
      for (std::int32_t j = 0; j < dims[1]; ++j)
        for (std::int32_t i = 0; i < dims[0]; ++i) {
          const double r = (Eigen::Vector3d(i, j, k) - centre).norm();
          auto& label = grid.labels[grid.geometry.index(i, j, k)];
          if (r < radius) label = hollow && r < radius - 3.0 ? 0 : 1;
        }
  }
  return grid;
}

double volume_mm3(const SurfaceMesh& mesh) {
  double sum = 0.0;
  const Eigen::Vector3d origin = mesh.vertices_mm.front().cast<double>();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices_mm[t[0]].cast<double>() - origin;
    const Eigen::Vector3d b = mesh.vertices_mm[t[1]].cast<double>() - origin;
    const Eigen::Vector3d c = mesh.vertices_mm[t[2]].cast<double>() - origin;
    sum += a.dot(b.cross(c)) / 6.0;
  }
  return sum;
}

/// Distance from a point (in voxels) to the nearest face between the label and the rest, in mm.
double distanceToBoundary_mm(const LabelGrid& grid, const Eigen::Vector3d& p) {
  const auto& g = grid.geometry;
  const auto inside = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    return g.contains(i, j, k) && grid.at(i, j, k) == 1;
  };
  double best = 1e9;
  const Eigen::Array3i at = p.array().round().cast<int>();
  for (int dk = -2; dk <= 2; ++dk)
    for (int dj = -2; dj <= 2; ++dj)
      for (int di = -2; di <= 2; ++di)
        for (int axis = 0; axis < 3; ++axis) {
          Eigen::Array3i low = at + Eigen::Array3i(di, dj, dk);
          Eigen::Array3i high = low;
          ++high[axis];
          if (inside(low[0], low[1], low[2]) == inside(high[0], high[1], high[2])) continue;
          // The face is the square between the two centres.
          Eigen::Vector3d off = p - low.cast<double>().matrix();
          for (int a = 0; a < 3; ++a) {
            off[a] = a == axis ? off[a] - 0.5 : std::max(0.0, std::abs(off[a]) - 0.5);
          }
          best = std::min(best, off.cwiseProduct(g.spacing * 1e3).norm());
        }
  return best;
}

struct SurfaceRoundTrip : testing::TestWithParam<const char*> {
  TestFolder folder;
};

TEST_P(SurfaceRoundTrip, KeepsTheBoundaryAndTheVolume) {
  std::printf("seeds 1 to %u\n", kSeeds);
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const LabelGrid labels = blobs(random);
    const GridGeometry& g = labels.geometry;
    test::makeCase(folder / ("case" + std::to_string(seed)), labels,
                   {{.name = "bone", .value = 1}});
    const fs::path file = folder / (std::to_string(seed) + GetParam());
    const auto report = test::exportCase(folder / ("case" + std::to_string(seed)), file);
    ASSERT_TRUE(report) << sentence(report.error());
    const auto mesh = readSurface(file, report->format);
    ASSERT_TRUE(mesh) << sentence(mesh.error());
    EXPECT_EQ(openEdges(*mesh), 0U);
    EXPECT_NEAR(static_cast<double>(mesh->triangles.size()), static_cast<double>(report->triangles),
                0.001 * static_cast<double>(report->triangles) + 1);
    double worst_mm = 0.0;
    for (const Eigen::Vector3f& p_mm : mesh->vertices_mm) {
      const Eigen::Vector3d p =
          (g.X_PV.inverse() * (p_mm.cast<double>() * 1e-3)).cwiseQuotient(g.spacing);
      worst_mm = std::max(worst_mm, distanceToBoundary_mm(labels, p));
    }
    const double voxels = static_cast<double>(
        std::count(labels.labels.begin(), labels.labels.end(), std::uint8_t{1}));
    const double true_mm3 = voxels * g.spacing.prod() * 1e9;
    const auto back = importLabels(file, g, "bone");
    ASSERT_TRUE(back) << sentence(back.error());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < labels.labels.size(); ++i) {
      changed += labels.labels[i] != back->grid.labels[i] ? 1 : 0;
    }
    std::printf(
        "  vertices at most %.3f mm from the boundary; volume %+.2f %%; %.2f %% of the "
        "voxels changed\n",
        worst_mm, 100.0 * (volume_mm3(*mesh) / true_mm3 - 1.0),
        100.0 * static_cast<double>(changed) / voxels);
    // Half the diagonal of a voxel.
    EXPECT_LE(worst_mm, 0.5e3 * g.spacing.norm());
    // Smoothing (sigma 0.7 voxels) takes from corners, edges and thin walls; blobs of some ten
    // voxels have many.
    EXPECT_NEAR(volume_mm3(*mesh), true_mm3, 0.06 * true_mm3);
    EXPECT_LT(static_cast<double>(changed), 0.02 * voxels);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, SurfaceRoundTrip, testing::Values(".stl", ".ply", ".obj"),
                         [](const auto& info) { return std::string(info.param).substr(1); });

/// A box of voxel faces, as 12 triangles, in voxels of a grid.
SurfaceMesh box(const GridGeometry& g, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  SurfaceMesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d p;
    for (unsigned a = 0; a < 3; ++a) p[a] = (corner >> a & 1U) != 0 ? high[a] : low[a];
    mesh.vertices_mm.emplace_back((g.X_PV * g.centre_V(p[0], p[1], p[2]) * 1e3).cast<float>());
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST(SurfaceVoxels, ABoxHoldsTheVoxelsWhoseCentresAreInside) {
  std::mt19937 random(21);
  std::printf("seed 21\n");
  std::uniform_real_distribution<double> place(-1.0, 9.0);
  for (int trial = 0; trial < 200; ++trial) {
    const GridGeometry g = test::obliqueGeometry(9, 7, 8);
    Eigen::Vector3d low(place(random), place(random), place(random));
    Eigen::Vector3d high(place(random), place(random), place(random));
    const Eigen::Vector3d lower = low.cwiseMin(high);
    high = low.cwiseMax(high);
    low = lower;
    const auto found = voxelsInside(box(g, low, high), g, "box");
    std::size_t expected = 0;
    for (std::int32_t k = 0; k < 8; ++k)
      for (std::int32_t j = 0; j < 7; ++j)
        for (std::int32_t i = 0; i < 9; ++i) {
          const Eigen::Array3d p(i, j, k);
          const bool in = (p > low.array()).all() && (p < high.array()).all();
          expected += in ? 1 : 0;
          if (found) {
            ASSERT_EQ(found->mask[g.index(i, j, k)] != 0, in) << trial;
          }
        }
    EXPECT_EQ(found.has_value(), expected > 0);
  }
}

TEST(SurfaceVoxels, RaysThroughEdgesAndCornersCountOnce) {
  // Corners and edges on the rows of voxel centres, where a careless test counts twice or not at
  // all. Without rotation, so that they are there exactly.
  GridGeometry g = test::obliqueGeometry(9, 9, 9);
  g.X_PV = Eigen::Isometry3d::Identity();
  g.spacing = Eigen::Vector3d::Constant(1e-3);
  // An octahedron around voxel (4, 4, 4).
  SurfaceMesh mesh;
  for (const auto& p :
       {Eigen::Vector3f(0.5F, 4, 4), Eigen::Vector3f(7.5F, 4, 4), Eigen::Vector3f(4, 1, 4),
        Eigen::Vector3f(4, 7, 4), Eigen::Vector3f(4, 4, 1), Eigen::Vector3f(4, 4, 7)}) {
    mesh.vertices_mm.push_back(p);
  }
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const auto found = voxelsInside(mesh, g, "octahedron");
  ASSERT_TRUE(found) << sentence(found.error());
  for (std::int32_t k = 0; k < 9; ++k)
    for (std::int32_t j = 0; j < 9; ++j)
      for (std::int32_t i = 0; i < 9; ++i) {
        const double r = std::abs(i - 4) / 3.5 + std::abs(j - 4) / 3.0 + std::abs(k - 4) / 3.0;
        if (std::abs(r - 1.0) < 1e-6) continue;  // on the surface: either is right
        ASSERT_EQ(found->mask[g.index(i, j, k)] != 0, r < 1.0) << i << " " << j << " " << k;
      }
}

struct SurfaceFile : testing::Test {
  TestFolder folder;
  GridGeometry geometry = test::obliqueGeometry(9, 7, 8);
  SurfaceMesh mesh = box(geometry, {1.5, 1.5, 1.5}, {6.5, 4.5, 5.5});

  fs::path write(const std::string& name, const std::string& bytes) const {
    test::writeAgain(folder / name, bytes);
    return folder / name;
  }
  void refused(const fs::path& file, const test::Refusal& refusal) const {
    expectRefusal(importLabels(file, geometry, ""), file, refusal);
  }
  [[nodiscard]] fs::path written(const std::string& name, ExchangeFormat format) const {
    EXPECT_TRUE(writeSurface(mesh, {1, 2, 3}, format, folder / name));
    return folder / name;
  }
  /// Labels of the box, from a file.
  void expectBox(const fs::path& file) const {
    const auto found = importLabels(file, geometry, "");
    ASSERT_TRUE(found) << sentence(found.error());
    EXPECT_EQ(std::count(found->grid.labels.begin(), found->grid.labels.end(), 1), 5 * 3 * 4);
    EXPECT_EQ(found->labels.front().name, "label-1");
  }
};

TEST_F(SurfaceFile, SaysThatItIsLpsAndHoldsNormalsAndColour) {
  const std::string stl = test::readBytes(written("a.stl", ExchangeFormat::Stl));
  EXPECT_EQ(stl.size(), 84U + 50U * 12U);
  EXPECT_THAT(stl.substr(0, 80), testing::HasSubstr("SPACE=LPS"));
  const std::string ply = test::readBytes(written("a.ply", ExchangeFormat::Ply));
  for (const char* line : {"format binary_little_endian 1.0", "SPACE=LPS", "property float nx",
                           "property uchar red", "element vertex 8", "element face 12"}) {
    EXPECT_THAT(ply, testing::HasSubstr(line));
  }
  const std::string obj = test::readBytes(written("a.obj", ExchangeFormat::Obj));
  EXPECT_THAT(obj,
              testing::StartsWith("# Palpate surface, patient coordinates in mm, SPACE=LPS\n"));
  EXPECT_THAT(obj, testing::HasSubstr("\nvn "));
}

TEST_F(SurfaceFile, IsReadInEveryEncoding) {
  expectBox(written("a.stl", ExchangeFormat::Stl));
  expectBox(written("a.ply", ExchangeFormat::Ply));
  expectBox(written("a.obj", ExchangeFormat::Obj));
  std::string stl = "solid box\n";
  std::string ply =
      "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 8\nproperty double x\n"
      "property double y\nproperty double z\nelement face 12\n"
      "property list uchar int vertex_indices\nend_header\n";
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 8\nproperty float x\n"
      "property float y\nproperty float z\nelement face 12\n"
      "property list uchar int vertex_index\nend_header\n";
  std::string faces;
  const auto bigEndian = [](const auto& value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    return std::string(bytes.rbegin(), bytes.rend());
  };
  for (const Eigen::Vector3f& p : mesh.vertices_mm) {
    char text[96];
    std::snprintf(text, sizeof text, "%.9g %.9g %.9g\n", p[0], p[1], p[2]);
    ply += text;
    for (const float c : p) big += bigEndian(c);
  }
  for (const auto& t : mesh.triangles) {
    stl += "facet normal 0 0 0\nouter loop\n";
    big += '\3';
    faces += "3";
    for (const std::uint32_t corner : t) {
      const Eigen::Vector3f& p = mesh.vertices_mm[corner];
      char text[96];
      std::snprintf(text, sizeof text, "vertex %.9g %.9g %.9g\n", p[0], p[1], p[2]);
      stl += text;
      big += bigEndian(corner);
      faces += ' ';
      faces += std::to_string(corner);
    }
    stl += "endloop\nendfacet\n";
    faces += "\n";
  }
  expectBox(write("text.stl", stl + "endsolid box\n"));
  expectBox(write("text.ply", ply + faces));
  expectBox(write("big.ply", big));
  // Quadrilaterals, and corners counted from the end.
  std::string obj;
  for (const Eigen::Vector3f& p : mesh.vertices_mm) {
    char text[96];
    std::snprintf(text, sizeof text, "v %.9g %.9g %.9g\r\n", p[0], p[1], p[2]);
    obj += text;
  }
  obj += "f 1/1/1 3/3 4 2\nf 5 6 8 7\nf 1//9 2 6 5\nf -6 -2 -1 -5\nf 1 5 7 3\nf 2 4 8 6\n";
  expectBox(write("quads.obj", obj));
}

TEST_F(SurfaceFile, RasIsTurned) {
  for (Eigen::Vector3f& p : mesh.vertices_mm) p.head<2>() *= -1.0F;
  std::string bytes = test::readBytes(written("a.stl", ExchangeFormat::Stl));
  bytes.replace(bytes.find("LPS"), 3, "RAS");
  expectBox(write("ras.stl", bytes));
}

TEST_F(SurfaceFile, OpenSurfaceIsRefused) {
  mesh.triangles.pop_back();
  refused(written("a.ply", ExchangeFormat::Ply),
          {"The surface is open, so that nothing is inside.", "edges",
           "3 edges of one triangle only", "every edge shared by two triangles"});
}

TEST_F(SurfaceFile, DamagedFilesAreRefused) {
  for (const auto& [name, format] : {std::pair{"a.stl", ExchangeFormat::Stl},
                                     {"a.ply", ExchangeFormat::Ply},
                                     {"a.obj", ExchangeFormat::Obj}}) {
    const std::string bytes = test::readBytes(written(name, format));
    const std::string kind = exchangeFormatName(format);
    if (format != ExchangeFormat::Obj) {
      refused(write(name, bytes.substr(0, bytes.size() - 1)),
              {"The " + kind + " file is damaged or cut short.", "", "", ""});
    }
    // The last corner of a text may lose digits and still be a number.
    for (std::size_t n = 0; n + 13 < bytes.size(); n += 13) {
      const auto found = importLabels(write(name, bytes.substr(0, n)), geometry, "");
      ASSERT_FALSE(found) << name << " of " << n << " bytes";
      EXPECT_EQ(found.error().kind, ErrorKind::InputRefused);
    }
  }
  refused(write("a.obj", "v 0 0 0\nf 1 2 3\n"),
          {"The OBJ file is damaged or cut short.", "", "", ""});
  refused(write("a.obj", "v 0 0 0\n"),
          {"The file holds no triangles.", "", "", "a closed surface"});
  refused(write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
          {"The OBJ file is damaged or cut short.", "", "", ""});
}

TEST_F(SurfaceFile, StatedCountsAreBoundedByTheFile) {
  std::string stl = test::readBytes(written("a.stl", ExchangeFormat::Stl));
  test::patch(stl, 80, std::uint32_t{0xFFFFFFFF});
  refused(write("a.stl", stl), {"The STL file is damaged or cut short.", "", "", ""});
  refused(write("a.ply",
                "ply\nformat ascii 1.0\nelement vertex 4000000000000\nproperty float x\n"
                "end_header\n1\n"),
          {"The PLY file is damaged or cut short.", "", "", ""});
  refused(write("b.ply",
                "ply\nformat binary_little_endian 1.0\nelement face 1\n"
                "property list uint int vertex_indices\nend_header\n\xFF\xFF\xFF\x7F"),
          {"The PLY file is damaged or cut short.", "", "", ""});
}

TEST_F(SurfaceFile, ADamagedByteNeitherCrashesNorHangs) {
  std::mt19937 random(test::damageSeed());
  for (const auto& [name, format] : {std::pair{"a.stl", ExchangeFormat::Stl},
                                     {"a.ply", ExchangeFormat::Ply},
                                     {"a.obj", ExchangeFormat::Obj}}) {
    const std::string bytes = test::readBytes(written(name, format));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(random());
      const auto found = importLabels(write(name, damaged), geometry, "");
      if (!found) {
        EXPECT_EQ(found.error().kind, ErrorKind::InputRefused) << name << " byte " << at;
      }
    }
  }
}

TEST_F(SurfaceFile, ElsewhereIsRefused) {
  for (Eigen::Vector3f& p : mesh.vertices_mm) p[0] += 500.0F;
  refused(written("a.stl", ExchangeFormat::Stl),
          {"The surface holds no voxel of the case's volume.", "vertices", "",
           "patient coordinates (LPS) in millimetres, within the volume"});
  for (Eigen::Vector3f& p : mesh.vertices_mm) p[0] += 5e8F;
  refused(written("b.stl", ExchangeFormat::Stl),
          {"The surface lies far from the case's volume.", "vertices", "",
           "patient coordinates (LPS) in millimetres"});
}

TEST_F(SurfaceFile, CutByTheVolumeIsSaid) {
  mesh = box(geometry, {-3, -3, -3}, {4.5, 20, 20});
  const auto found = importLabels(written("a.stl", ExchangeFormat::Stl), geometry, "");
  ASSERT_TRUE(found);
  EXPECT_THAT(found->warnings,
              testing::ElementsAre("The surface reaches out of the volume and is cut there."));
  EXPECT_EQ(std::count(found->grid.labels.begin(), found->grid.labels.end(), 1), 5 * 7 * 8);
}

TEST(LabelSurface, ThinAndEmptyLabelsAreRefused) {
  LabelGrid grid{test::obliqueGeometry(9, 9, 9), std::vector<std::uint8_t>(729, 0)};
  EXPECT_EQ(labelSurface(grid, 1).error().message, "The label holds no voxels.");
  grid.labels[grid.geometry.index(4, 4, 4)] = 1;
  EXPECT_EQ(labelSurface(grid, 1).error().message, "The label is too thin to have a surface.");
}

}  // namespace
}  // namespace palpate
