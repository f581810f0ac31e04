#pragma once
/// Small volumes for tests, and ways to make files that are wrong in one thing.

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "imaging/volume.h"

namespace palpate::test {

inline GridGeometry obliqueGeometry(std::int32_t nx, std::int32_t ny, std::int32_t nz) {
  GridGeometry g;
  g.dims = {nx, ny, nz};
  g.spacing = Eigen::Vector3d(0.859375, 0.71, 1.3) * 1e-3;
  g.X_PV.linear() = (Eigen::AngleAxisd(0.41, Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(2.3, Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
  g.X_PV.translation() = Eigen::Vector3d(-81.237, 112.5, 63.0417) * 1e-3;
  return g;
}

/// Values of a fixed seed over the whole int16 range.
inline Volume int16Volume(const GridGeometry& geometry, unsigned seed = 7) {
  Volume v;
  v.geometry = geometry;
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> values(-32768, 32767);
  v.int16.resize(geometry.voxelCount());
  for (auto& x : v.int16) x = static_cast<std::int16_t>(values(random));
  return v;
}

inline Volume float32Volume(const GridGeometry& geometry, unsigned seed = 8) {
  Volume v;
  v.geometry = geometry;
  v.type = VoxelType::Float32;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> values(-3.0F, 5.0F);
  v.float32.resize(geometry.voxelCount());
  for (auto& x : v.float32) x = values(random);
  return v;
}

inline std::string readBytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

template <class T>
void patch(std::string& bytes, std::size_t at, T value) {
  bytes.replace(at, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
}

inline std::size_t filesIn(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace palpate::test
