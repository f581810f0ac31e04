#pragma once
/// Contacts by the definition in the design, sharing no code with core: distances by exhaustive
/// search, interpolation by the sum over eight corners, every point tried.

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "core/collision/contact_finder.h"
#include "core/voxels/label_grid.h"

namespace palpate::oracle {

/// Signed D at every voxel centre, metres, > 0 outside; +-HUGE_VAL where there is no other kind.
std::vector<double> signedDistances(const LabelGrid& grid);

struct Truth {
  bool inside = false;
  double value = 0;  ///< Distance leaves: the interpolated value. Voxel leaves: 0.
};

/// Is p_V in contact, by the leaf model?
Truth contactAt(const LabelGrid& grid, const std::vector<double>& distance, LeafModel leaf,
                const Eigen::Vector3d& p_V);

Eigen::Isometry3d randomPose(std::mt19937& rng, const Eigen::Vector3d& around, double spread);
/// Points in a box of this half edge around the origin, with random unit normals.
PointShell randomShell(std::mt19937& rng, std::size_t count, const Eigen::Vector3d& half);
Eigen::Vector3d middleOf(const GridGeometry& geometry);

/// Runs the finder with room for every contact.
std::vector<Contact> findAll(const VoxelTree& tree, const PointShell& shell,
                             const QueryOptions& options, const Eigen::Isometry3d& X_VT);

}  // namespace palpate::oracle
