#pragma once
/// Where the voxels of a volume are: counts, spacing, and the pose of its axes in the patient.
///
/// Frames: V = voxel axes, origin at the centre of the first voxel, metres; P = patient, DICOM LPS
/// (x towards the patient's left, y posterior, z superior), metres. X_PV maps V to P.
/// Voxel (i,j,k) has its centre at (i·sx, j·sy, k·sz) in V and is the half-open box around it.

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Two grids within this are one, metres.
inline constexpr double kSameGeometry_m = 1e-6;

struct GridGeometry {
  std::array<std::int32_t, 3> dims{0, 0, 0};                  ///< Voxels along x, y, z.
  Eigen::Vector3d spacing = Eigen::Vector3d::Constant(1e-3);  ///< Metres, > 0 per axis.
  Eigen::Isometry3d X_PV = Eigen::Isometry3d::Identity();

  [[nodiscard]] std::size_t voxelCount() const noexcept;
  /// Linear index, x fastest. The caller checks the range with contains().
  [[nodiscard]] std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(dims[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(dims[0]) +
           static_cast<std::size_t>(i);
  }
  [[nodiscard]] bool contains(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return i >= 0 && j >= 0 && k >= 0 && i < dims[0] && j < dims[1] && k < dims[2];
  }
  /// Centre of a voxel in V, metres.
  [[nodiscard]] Eigen::Vector3d centre_V(double i, double j, double k) const noexcept {
    return {i * spacing.x(), j * spacing.y(), k * spacing.z()};
  }
  /// The voxel whose half-open box holds p_V; may lie outside the grid.
  [[nodiscard]] std::array<std::int32_t, 3> voxelAt(const Eigen::Vector3d& p_V) const noexcept;
  /// Centres of the eight corner voxels in P, metres; x fastest.
  [[nodiscard]] std::array<Eigen::Vector3d, 8> cornerCentres_P() const noexcept;
  /// Largest distance between matching corners of two grids, metres.
  [[nodiscard]] double cornerDistance(const GridGeometry& other) const noexcept;
  /// As many voxels, corners within a micrometre: what other programs keep of a grid that they
  /// write.
  [[nodiscard]] bool sameAs(const GridGeometry& other) const noexcept;
};

}  // namespace palpate
