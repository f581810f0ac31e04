#include "core/devices/vendor_scheduler.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <thread>

#include "core/devices/hd_error.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

// A scheduler that has died would never send the zero wrench; then stopping it is all that is left.
constexpr auto kLongestQuieting = 200ms;
// The vendor's stack is short; a library that reports without end must not hold the servo.
constexpr int kErrorsPerDrain = 16;

template <class Condition>
void waitFor(std::chrono::milliseconds longest, Condition done) {
  const auto end = std::chrono::steady_clock::now() + longest;
  while (!done() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(500us);
}

}  // namespace

const hd::ErrorInfo* causeOf(const std::vector<hd::ErrorInfo>& errors) noexcept {
  const hd::ErrorInfo* cause = nullptr;
  for (const hd::ErrorInfo& error : errors)
    if (cause == nullptr || hd::meaningOf(error.code).state >= hd::meaningOf(cause->code).state)
      cause = &error;
  return cause;
}

std::string errorText(const hd::ErrorInfo& error) {
  char text[96];
  std::snprintf(text, sizeof text, "%s (0x%X, internal %d)", hd::meaningOf(error.code).name,
                error.code, error.internalCode);
  return text;
}

VendorScheduler& VendorScheduler::of(const hd::Library& library) {
  static std::mutex* const mutex = new std::mutex;
  static auto* const all = new std::map<const hd::Library*, std::unique_ptr<VendorScheduler>>;
  const std::lock_guard lock(*mutex);
  auto& slot = (*all)[&library];
  if (!slot) slot.reset(new VendorScheduler(library));
  return *slot;
}

VendorScheduler::VendorScheduler(const hd::Library& library) : library_(library) {
  for (Slot& slot : slots_) slot.scheduler = this;
}

hd::CallbackCode VendorScheduler::callback(void* p) noexcept {
  Slot& slot = *static_cast<Slot*>(p);
  slot.inside.store(true);
  VendorDevice* device = slot.device.load();
  if (device != nullptr) device->onTick(*slot.scheduler);
  slot.inside.store(false);
  return device != nullptr ? hd::kContinue : hd::kDone;
}

void VendorScheduler::quietAll() noexcept {
  for (Slot& slot : slots_)
    if (VendorDevice* device = slot.device.load()) device->hush(true);
  waitFor(kLongestQuieting, [this] {
    return std::all_of(slots_.begin(), slots_.end(), [](const Slot& slot) {
      const VendorDevice* device = slot.device.load();
      return device == nullptr || device->quietTicks() >= kQuietTicks;
    });
  });
}

void VendorScheduler::stop() noexcept {
  if (!running_) return;
  quietAll();
  library_.api.stopScheduler();
  running_ = false;
  // The vendor does not promise that the last callback has returned by now.
  waitFor(kLongestQuieting, [this] {
    return std::none_of(slots_.begin(), slots_.end(),
                        [](const Slot& slot) { return slot.inside.load(); });
  });
}

Result<void> VendorScheduler::start() {
  const bool anyone = std::any_of(slots_.begin(), slots_.end(),
                                  [](const Slot& slot) { return slot.device.load() != nullptr; });
  if (!anyone) return {};
  for (Slot& slot : slots_)
    if (VendorDevice* device = slot.device.load()) device->hush(false);
  takeErrors();
  library_.api.startScheduler();
  // Before the first tick could add its own: an error now is the start's.
  const hd::ErrorInfo error = library_.api.getError();
  if (error.code != hd::kSuccess && hd::meaningOf(error.code).healTicks == 0) {
    library_.api.stopScheduler();
    return fail(machineError("The vendor's scheduler did not start.")
                    .butFound(errorText(error))
                    .advise(hd::meaningOf(error.code).sentence));
  }
  running_ = true;
  return {};
}

Result<void> VendorScheduler::whileStopped(const std::function<Result<void>()>& change) {
  const std::lock_guard lock(mutex_);
  stop();
  takeErrors();  // of the past; they were the callbacks' to report
  library_.api.setSchedulerRate(kRate);
  takeErrors();  // a rate that it cannot do shows in the device's update rate
  Result<void> changed = change();
  Result<void> started = start();
  return changed ? started : changed;
}

Result<void> VendorScheduler::add(VendorDevice& device) {
  const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                 [](const Slot& s) { return s.device.load() == nullptr; });
  if (slot == slots_.end())
    return fail(usageError("Palpate drives at most four Phantoms at once.")
                    .advise("Close one of them first."));
  slot->device.store(&device);
  takeErrors();
  slot->handle =
      library_.api.scheduleAsynchronous(&VendorScheduler::callback, &*slot, hd::kHighestPriority);
  const auto errors = takeErrors();
  if (const hd::ErrorInfo* cause = causeOf(errors)) {
    slot->device.store(nullptr);
    return fail(machineError("The vendor's scheduler did not take the servo.")
                    .butFound(errorText(*cause))
                    .advise(hd::meaningOf(cause->code).sentence));
  }
  return {};
}

void VendorScheduler::remove(VendorDevice& device) noexcept {
  for (Slot& slot : slots_) {
    if (slot.device.load() != &device) continue;
    library_.api.unschedule(slot.handle);
    slot.device.store(nullptr);
  }
}

std::vector<hd::ErrorInfo> VendorScheduler::takeErrors() {
  std::vector<hd::ErrorInfo> errors;
  for (int i = 0; i < kErrorsPerDrain; ++i) {
    const hd::ErrorInfo error = library_.api.getError();
    if (error.code == hd::kSuccess) break;
    errors.push_back(error);
  }
  return errors;
}

void VendorScheduler::routeErrors(VendorDevice& current) noexcept {
  for (int i = 0; i < kErrorsPerDrain; ++i) {
    const hd::ErrorInfo error = library_.api.getError();
    if (error.code == hd::kSuccess) return;
    VendorDevice* named = &current;
    for (const Slot& slot : slots_) {
      VendorDevice* device = slot.device.load();
      if (device != nullptr && device->handle() == error.device) named = device;
    }
    named->noteError(error);
  }
}

}  // namespace palpate
