#pragma once
/// Libraries that solve wider problems, each asked what comes nearest; built where they are found.
/// And the finder of core/collision itself.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "core/voxels/label_grid.h"
#include "tests/benchmarks/dense_field.h"
#include "tests/benchmarks/peer.h"

namespace palpate::bench {

/// Null where the library is missing or the world is beyond what it can hold.
[[nodiscard]] std::unique_ptr<Peer> makeOpenVdb(const DenseField& field,
                                                const std::vector<Eigen::Vector3d>& points_T);
[[nodiscard]] std::unique_ptr<Peer> makeFcl(const LabelGrid& grid,
                                            const std::vector<Eigen::Vector3d>& points_T);
[[nodiscard]] std::unique_ptr<Peer> makeBullet(const DenseField& field,
                                               const std::vector<Eigen::Vector3d>& points_T);
/// core/collision: "hierarchy", "paper", "voxel" for the default with voxel leaves, or the default
/// with one of its options: "threads=2", "contact_budget=300".
[[nodiscard]] std::unique_ptr<Peer> makePalpate(const LabelGrid& grid,
                                                const std::vector<Eigen::Vector3d>& points_T,
                                                const std::string& method);

}  // namespace palpate::bench
