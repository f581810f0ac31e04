#pragma once
/// What a session and a scene must share to be the same simulation.

#include <cstdint>

#include "core/simulation/approach.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// The values that a prepared scene feels, those of loose bodies among them.
[[nodiscard]] FeltLabels feltLabelsOf(const PreparedScene& prepared);

/// Of geometry, felt labels, their materials, loose bodies, instrument, and setting. Labels that
/// are not felt do not count, nor does where the device stands: samples are recorded in the world.
/// What cannot be reached counts where it is left out of the tree.
[[nodiscard]] std::uint64_t fingerprintOf(const PreparedScene& prepared, const FeltLabels& felt);

}  // namespace palpate
