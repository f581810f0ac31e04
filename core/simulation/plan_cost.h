#pragma once
/// What each row of a plan costs, measured on this machine.
///
/// A hand on rails comes down on the anatomy where the device stands, presses 1 mm in and circles
/// there, on a virtual clock: a step as the scene has it, the same with one effect on or off, and
/// the contact query alone at the same poses; the same 30 mm above, in no contact. Medians over the
/// steps, the least of three runs, taken in turn:
///   contact query    = the query alone
///   coupling, motion = a step in no contact, less its query
///   contact response = a step in contact without friction, less the two above
///   any effect       = a step with it, less one without
/// So what lies below some ten nanoseconds is noise, and shown as 0. Not for the loops.

#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// µs a step, by effect.
struct StepCosts {
  double query = 0, motion = 0, response = 0;
  double friction = 0;                       ///< On less off, whichever the scene has.
  double bodies = 0, gravity = 0, drag = 0;  ///< 0 in a scene without loose bodies.
  double contacts = 0;                       ///< Mean of the steps measured.
};

[[nodiscard]] StepCosts measureStep(const std::shared_ptr<const PreparedScene>& scene);

enum class WholeTree : std::uint8_t { Skip, Build };

/// The scene's plan with its costs. With WholeTree::Build the trees of the anatomy without its
/// region, without the device's reach and with its cavities are built too, so that what is left out
/// has exact bytes.
[[nodiscard]] Result<std::vector<PlanRow>> measuredPlan(
    const std::shared_ptr<const PreparedScene>& scene, WholeTree whole,
    const Progress& progress = {});

}  // namespace palpate
