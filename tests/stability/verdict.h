#pragma once
/// What a run of the closed loop was like, by the thresholds of haptics_facts.md §4.

#include <string>
#include <vector>

#include "core/haptics/servo_loop.h"

namespace palpate::stability {

enum class Verdict {
  Pass,       ///< Every threshold holds.
  Guarded,    ///< Not steady, but the guards held: energy, slew, clamps; the force is bounded.
  Exception,  ///< A promise was broken.
};
[[nodiscard]] const char* name(Verdict verdict);

/// What a row of the matrix allows.
struct Thresholds {
  double roughness = 0.08;  ///< N a tick: mean change of the force over the worst 200 ticks
  double deepest = 1e-4;    ///< m
};

struct Judged {
  Verdict verdict = Verdict::Pass;
  std::string why;  ///< What did not hold; empty where all did.
  double lowestEnergy = 0.0, largestForce = 0.0, largestRise = 0.0, roughness = 0.0;
  double deepest = 0.0;
  bool fault = false;
};

/// Energy, slew and clamps are recomputed from the samples.
[[nodiscard]] Judged judge(const std::vector<ServoSample>& samples, const SafetyLimits& limits,
                           double deepest, const Thresholds& thresholds);

}  // namespace palpate::stability
