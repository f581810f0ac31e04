#include "tests/benchmarks/skull.h"

#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace palpate::bench {
namespace {

constexpr int kNx = 256, kNy = 256, kNz = 108;
constexpr double kStep[3] = {0.95703e-3, 0.95703e-3, 1.5e-3};  // metres
constexpr std::size_t kBytes = std::size_t{kNx} * kNy * kNz * 2;
constexpr double kBone = 300;  // HU

// The member matrix.dat of the gzipped tar: int16, x fastest.
std::vector<std::int16_t> readVoxels(const std::string& path) {
  std::vector<std::int16_t> voxels;
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return voxels;
  char header[512];
  while (gzread(file, header, sizeof header) == static_cast<int>(sizeof header) && header[0] != 0) {
    const std::string name(header, strnlen(header, 100));
    const auto size = static_cast<std::size_t>(std::strtoull(header + 124, nullptr, 8));
    if (name.size() >= 10 && name.substr(name.size() - 10) == "matrix.dat" && size == kBytes) {
      voxels.resize(kBytes / 2);
      if (gzread(file, voxels.data(), static_cast<unsigned>(kBytes)) != static_cast<int>(kBytes)) {
        voxels.clear();
      }
      break;
    }
    gzseek(file, static_cast<z_off_t>((size + 511) / 512 * 512), SEEK_CUR);
  }
  gzclose(file);
  return voxels;
}

}  // namespace

std::optional<LabelGrid> skull(double spacing) {
  const char* given = std::getenv("PALPATE_DEMO_SCAN");
  const auto voxels = readVoxels(
      given != nullptr ? given : "/usr/share/doc/invesalius-examples/examples/Cranium.inv3");
  if (voxels.empty()) return std::nullopt;
  const int size[3] = {kNx, kNy, kNz};
  LabelGrid grid;
  grid.geometry.spacing = Eigen::Vector3d::Constant(spacing);
  for (std::size_t a = 0; a < 3; ++a) {
    grid.geometry.dims[a] = static_cast<std::int32_t>((size[a] - 1) * kStep[a] / spacing) + 1;
  }
  grid.labels.resize(grid.geometry.voxelCount());
  const auto at = [&](int i, int j, int k) {
    return static_cast<double>(
        voxels[(static_cast<std::size_t>(k) * kNy + static_cast<std::size_t>(j)) * kNx +
               static_cast<std::size_t>(i)]);
  };
  const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
  std::size_t to = 0;
  for (int k = 0; k < grid.geometry.dims[2]; ++k) {
    for (int j = 0; j < grid.geometry.dims[1]; ++j) {
      for (int i = 0; i < grid.geometry.dims[0]; ++i, ++to) {
        const int cell[3] = {i, j, k};
        int c[3];
        double f[3];
        for (std::size_t a = 0; a < 3; ++a) {
          const double u = cell[a] * spacing / kStep[a];
          c[a] = std::min(static_cast<int>(u), size[a] - 2);
          f[a] = u - c[a];
        }
        double slice[2];
        for (int z = 0; z < 2; ++z) {
          slice[z] =
              mix(mix(at(c[0], c[1], c[2] + z), at(c[0] + 1, c[1], c[2] + z), f[0]),
                  mix(at(c[0], c[1] + 1, c[2] + z), at(c[0] + 1, c[1] + 1, c[2] + z), f[0]), f[1]);
        }
        grid.labels[to] = mix(slice[0], slice[1], f[2]) >= kBone ? 1 : 0;
      }
    }
  }
  return grid;
}

}  // namespace palpate::bench
