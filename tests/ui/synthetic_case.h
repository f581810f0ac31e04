#pragma once
/// A head that nobody has: an ellipsoid of "skin" with a shell of "bone" in it, holes for two eyes
/// and a nose, teeth and a spine. Drawn from formulas, so that golden pictures show no patient.

#include <Eigen/Geometry>
#include <cstdint>

#include "core/geometry/triangle_mesh.h"
#include "core/scene/instrument.h"
#include "core/simulation/snapshot.h"
#include "core/voxels/label_grid.h"
#include "imaging/volume.h"

namespace palpate::test {

/// CT of dims³-like size, HU, patient axes.
[[nodiscard]] Volume syntheticHead(std::int32_t size);
/// Label 1 where the synthetic head is bone.
[[nodiscard]] LabelGrid syntheticBone(const Volume& head);
/// A burr on a shaft, closed.
[[nodiscard]] Instrument syntheticBurr();
/// The burr pressed into the forehead, with contacts on its ball and a force.
[[nodiscard]] Snapshot syntheticContact(const Volume& head);

}  // namespace palpate::test
