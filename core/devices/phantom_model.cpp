#include "core/devices/phantom_model.h"

#include <algorithm>
#include <cmath>

#include "core/devices/arm_model.h"

namespace palpate {
namespace {

// N·m. The weakest axis of the Premiums (roll) peaks here, so that none is asked for more than it
// has.
constexpr double kPremiumTorque = 0.170;

/// HDAPI's model strings and the arm that they mean.
struct ModelName {
  const char* reported;
  const char* model;
};
constexpr ModelName kNames[] = {
    {"Touch", "touch"},
    {"PHANTOM Omni", "touch"},
    {"Touch X", "touch-x"},
    {"PHANTOM Desktop", "touch-x"},
    {"PHANTOM Premium 1.5 6DOF", "premium-6dof"},
    {"PHANTOM Premium 3.0 6DOF", "premium-3-6dof"},
};

/// The reported string may carry an edition after the name: the longest name that begins it wins.
std::string modelOf(const std::string& reported) {
  std::string model = "phantom";
  std::size_t length = 0;
  for (const ModelName& known : kNames) {
    const std::string name = known.reported;
    const bool begins = reported.compare(0, name.size(), name) == 0;
    const bool ends = reported.size() == name.size() || (begins && reported[name.size()] == ' ');
    if (!begins || !ends || name.size() <= length) continue;
    model = known.model;
    length = name.size();
  }
  return model;
}

DeviceInfo arm(const std::string& model) {
  for (const ArmParameters& known : armModels())
    if (known.info.model == model) return known.info;
  return {};
}

/// Gains and limits; of the weakest arm where the model is not known (haptics_facts.md §2, §3).
DeviceInfo tableInfo(const std::string& model) {
  DeviceInfo info = arm(model == "phantom" ? "touch" : model);
  if (model == "premium-3-6dof") {
    info = arm("premium-6dof");
    info.peakForce = 22.0;
    info.continuousForce = 3.0;
    info.workspaceMin = {-0.419, -0.292, -0.203};
    info.workspaceMax = {0.419, 0.292, 0.203};
  }
  info.model = model;
  info.simulated = false;
  return info;
}

/// A limit that the device reports may only lower the table's.
double lower(double table, double reported) {
  return std::isfinite(reported) && reported > 0.0 ? std::min(table, reported) : table;
}

bool plausible(const PhantomFacts& facts) {
  for (std::size_t i = 0; i < 3; ++i)
    if (!(facts.workspaceMax[i] - facts.workspaceMin[i] > 0.01)) return false;
  return true;
}

}  // namespace

DeviceInfo deviceInfo(const PhantomFacts& facts) {
  DeviceInfo info = tableInfo(modelOf(facts.model));
  info.name = facts.model.empty() ? "Phantom" : facts.model;
  if (!facts.configuredName.empty()) info.name += " (" + facts.configuredName + ")";
  info.peakForce = lower(info.peakForce, facts.peakForce);
  info.continuousForce = lower(info.continuousForce, facts.continuousForce);
  // A six-degree device that is not in the table says itself what it can, or gets no torque.
  const bool knownTorque = info.feelsTorque || facts.peakTorque > 0.0;
  info.feelsTorque = facts.outputDof == 6 && knownTorque;
  info.peakTorque = info.feelsTorque ? lower(kPremiumTorque, facts.peakTorque) : 0.0;
  if (plausible(facts)) {
    info.workspaceMin = facts.workspaceMin;
    info.workspaceMax = facts.workspaceMax;
  }
  return info;
}

}  // namespace palpate
