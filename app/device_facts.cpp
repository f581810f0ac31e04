#include "app/device_facts.h"

#include "core/devices/simulated_phantom.h"

namespace palpate {

DeviceInfo deviceFacts(const std::string& name) {
  for (const std::string& model : {name, std::string("touch-x")}) {
    const auto device = makeSimulatedPhantom(model, makeSearchingHand(1), 1);
    if (device) return (*device)->info();
  }
  return {};
}

}  // namespace palpate
