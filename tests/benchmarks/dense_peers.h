#pragma once
/// The peers that look up a dense float field, and the scalar reference. All but the reference need
/// cubic voxels.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "tests/benchmarks/dense_field.h"
#include "tests/benchmarks/peer.h"
#include "tests/benchmarks/probe_tree.h"

namespace palpate::bench {

/// Every point in double precision, one after the other: what all others are checked against.
[[nodiscard]] std::unique_ptr<Peer> makeScalarReference(
    const DenseField& field, const std::vector<Eigen::Vector3d>& points_T);

/// Every point, as many at a time as the machine has lanes.
[[nodiscard]] std::unique_ptr<Peer> makeDenseSimd(const DenseField& field, const ProbeTree& probe);

/// The rival as published: a 16-ary sphere tree over the probe's points; a node's 16 children are
/// one batch, each looks up the field at its centre and lives when that is not above its radius.
[[nodiscard]] std::unique_ptr<Peer> makeRival(const DenseField& field, const ProbeTree& probe);

/// The same with every trick of ours that helped it: nodes read one nearest sample before they read
/// eight, points lie leaf by leaf, leaves run in passes (cells, values by scalar loads, arithmetic)
/// over blocks that stay in the first cache, normals are taken of packed contacts only.
[[nodiscard]] std::unique_ptr<Peer> makeTunedRival(const DenseField& field, const ProbeTree& probe);

}  // namespace palpate::bench
