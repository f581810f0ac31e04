#include "tests/stability/verdict.h"

#include <cmath>

#include "tests/stability/recompute.h"

namespace palpate::stability {
namespace {

constexpr double kEnergy = -20e-6;        // J; design: the promise
constexpr double kEnergyFault = -520e-6;  // J; where the energy fault has cut the force

bool finite(const std::vector<ServoSample>& samples) {
  for (const ServoSample& s : samples) {
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(s.wrench.force[i] + s.wrench.torque[i] + s.device.pose.p[i])) return false;
    }
  }
  return true;
}

}  // namespace

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::Pass:
      return "pass";
    case Verdict::Guarded:
      return "guarded";
    case Verdict::Exception:
      return "exception";
  }
  return "?";
}

Judged judge(const std::vector<ServoSample>& samples, const SafetyLimits& limits, double deepest,
             const Thresholds& thresholds) {
  const Recomputed m = recompute(samples, limits.continuousForce);
  Judged out;
  out.lowestEnergy = m.lowestEnergy;
  out.largestForce = m.largestForce;
  out.largestRise = m.largestRise;
  out.roughness = m.roughness;
  out.deepest = deepest;
  SafetyFault fault = SafetyFault::None;
  for (const ServoSample& s : samples) fault = s.fault != SafetyFault::None ? s.fault : fault;
  out.fault = fault != SafetyFault::None;

  const auto fails = [&out](Verdict verdict, const char* why) {
    out.verdict = std::max(out.verdict, verdict);
    out.why += (out.why.empty() ? "" : ", ") + std::string(why);
  };
  if (!finite(samples)) fails(Verdict::Exception, "not finite");
  const bool energyFault = fault == SafetyFault::EnergyGenerated;
  if (m.lowestEnergy < (energyFault ? kEnergyFault : kEnergy)) fails(Verdict::Exception, "energy");
  if (m.largestRise > limits.forceSlew + 1e-9) fails(Verdict::Exception, "slew");
  if (m.largestForce > limits.peakForce + 1e-9) fails(Verdict::Exception, "peak");
  if (m.largestTorque > limits.peakTorque + 1e-9) fails(Verdict::Exception, "torque");
  if (m.longestAbove > static_cast<int>(limits.peakTicks)) fails(Verdict::Exception, "continuous");
  if (out.fault) fails(Verdict::Guarded, "fault");
  if (out.roughness > thresholds.roughness) fails(Verdict::Guarded, "ripple");
  if (deepest > thresholds.deepest) fails(Verdict::Guarded, "depth");
  return out;
}

}  // namespace palpate::stability
