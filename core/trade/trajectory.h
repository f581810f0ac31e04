#pragma once
/// The motion that every setting of a sweep is put through: an approach and a slide.

#include <cstdint>
#include <vector>

#include "core/haptics/messages.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// Device samples in W, one a step of the scene's own period, about three seconds: down along -y of
/// D from 10 mm above the surface to 1.5 mm below it, then to and fro within 8 mm. The seed turns
/// and times the slide. Same scene and seed, same bits.
[[nodiscard]] std::vector<DeviceSample> approachAndSlide(const PreparedScene& scene,
                                                         std::uint64_t seed);

}  // namespace palpate
