#include "core/devices/phantom_facts.h"

#include <cmath>
#include <limits>

#include "core/devices/hd_error.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

constexpr double kNewtonMetresPerMillinewtonMetre = 1e-3;
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

std::string spoken(const std::string& name) {
  return name.empty() ? "the default device" : "\"" + name + "\"";
}

/// One property at a time, so that an error is this property's: then it has none.
class Questions {
 public:
  explicit Questions(VendorScheduler& scheduler)
      : scheduler_(scheduler), api_(scheduler.library().api) {}

  std::string text(hd::Enum what) {
    scheduler_.takeErrors();
    const char* said = api_.getString(what);
    return scheduler_.takeErrors().empty() && said != nullptr ? said : "";
  }
  double number(hd::Enum what) {
    double values[8] = {kNothing};
    return answered([&] { api_.getDoublev(what, values); }) ? values[0] : kNothing;
  }
  int integer(hd::Enum what, int otherwise) {
    std::int32_t values[8] = {otherwise};
    return answered([&] { api_.getIntegerv(what, values); }) ? values[0] : otherwise;
  }
  bool has(hd::Enum doubles) { return std::isfinite(number(doubles)); }
  bool hasSwitch(hd::Enum what) {
    hd::Boolean values[8] = {};
    return answered([&] { api_.getBooleanv(what, values); });
  }
  void workspace(PhantomFacts& facts) {
    double box[8] = {};
    if (!answered([&] { api_.getDoublev(hd::kUsableWorkspace, box); })) return;
    for (std::size_t i = 0; i < 3; ++i) {
      facts.workspaceMin[i] = metres(box[i]);
      facts.workspaceMax[i] = metres(box[i + 3]);
    }
  }

 private:
  template <class Ask>
  bool answered(Ask ask) {
    scheduler_.takeErrors();
    ask();
    return scheduler_.takeErrors().empty();
  }
  VendorScheduler& scheduler_;
  const hd::Api& api_;
};

/// Which error tells a person most: a name that is not configured says little.
bool tellsMore(const hd::ErrorInfo& error) {
  return error.code >= hd::kWarmMotors && error.code != hd::kDeviceFaultCode;
}

}  // namespace

Result<TakenDevice> takeDevice(VendorScheduler& scheduler, const std::vector<std::string>& names) {
  const hd::Api& api = scheduler.library().api;
  std::string tried, advice;
  for (const std::string& name : names) {
    scheduler.takeErrors();
    const hd::Handle handle = api.initDevice(name.empty() ? nullptr : name.c_str());
    const auto errors = scheduler.takeErrors();
    const hd::ErrorInfo* cause = causeOf(errors);
    if (handle != hd::kInvalidHandle && cause == nullptr) return TakenDevice{handle, name};
    if (handle != hd::kInvalidHandle) {
      api.disableDevice(handle);
      scheduler.takeErrors();
    }
    tried += (tried.empty() ? "" : "; ") + spoken(name) + ": " +
             (cause != nullptr ? errorText(*cause) : "no device and no reason given");
    if (cause != nullptr && advice.empty() && tellsMore(*cause))
      advice = hd::meaningOf(cause->code).sentence;
  }
  if (advice.empty())
    advice =
        "Check that the device is switched on and plugged in, that the vendor's set-up tool lists "
        "it under this name (its folder is named by GTDD_HOME), and that you may use its port.";
  return fail(machineError("No Phantom answered.")
                  .inField("device")
                  .butFound(tried.empty() ? "no name to try" : tried)
                  .advise(advice));
}

AskedDevice askDevice(VendorScheduler& scheduler, const TakenDevice& device) {
  AskedDevice asked;
  PhantomFacts& facts = asked.facts;
  scheduler.library().api.makeCurrentDevice(device.handle);
  Questions ask(scheduler);
  facts.configuredName = device.name;
  facts.model = ask.text(hd::kModelType);
  facts.vendor = ask.text(hd::kVendor);
  facts.driverVersion = ask.text(hd::kDriverVersion);
  facts.libraryVersion = ask.text(hd::kVersion);
  facts.serial = ask.text(hd::kSerialNumber);
  // A number by the documentation (2.04), a text in some releases.
  const double firmware = ask.number(hd::kFirmwareVersion);
  facts.firmware = std::isfinite(firmware) ? std::to_string(firmware).substr(0, 5)
                                           : ask.text(hd::kFirmwareVersion);
  facts.outputDof = ask.integer(hd::kOutputDof, 3);
  facts.updateRate = ask.integer(hd::kUpdateRate, 0);
  facts.calibrationStyles = static_cast<std::uint32_t>(ask.integer(hd::kCalibrationStyle, 0));
  facts.peakForce = ask.number(hd::kMaxForce);
  facts.continuousForce = ask.number(hd::kMaxContinuousForce);
  if (facts.outputDof == 6) {
    facts.peakTorque = ask.number(hd::kMaxTorque) * kNewtonMetresPerMillinewtonMetre;
    facts.continuousTorque =
        ask.number(hd::kMaxContinuousTorque) * kNewtonMetresPerMillinewtonMetre;
  }
  ask.workspace(facts);
  asked.setup.handle = device.handle;
  asked.setup.inkwell = ask.hasSwitch(hd::kInkwellSwitch);
  asked.setup.warmth = ask.has(hd::kMotorTemperature);
  asked.setup.style = chooseCalibrationStyle(facts.calibrationStyles);
  asked.setup.torque = deviceInfo(facts).feelsTorque;
  return asked;
}

}  // namespace palpate
