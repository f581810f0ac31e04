#include "core/devices/hdapi.h"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>

namespace palpate::hd {
namespace {

/// The first word of a loader message "libX.so: cannot open ..." is the file it is about.
std::string fileNamedBy(const std::string& loaderMessage) {
  return loaderMessage.substr(0, loaderMessage.find(':'));
}

std::string symbolNamedBy(const std::string& loaderMessage) {
  const std::string mark = "undefined symbol: ";
  const auto at = loaderMessage.find(mark);
  if (at == std::string::npos) return {};
  const auto begin = at + mark.size();
  return loaderMessage.substr(begin, loaderMessage.find_first_of(" ,\n", begin) - begin);
}

/// What the loader said, as a sentence and a next step.
LibraryAttempt explain(const std::string& name, const std::string& message) {
  LibraryAttempt attempt{name, {}, {}};
  if (const std::string symbol = symbolNamedBy(message); !symbol.empty()) {
    attempt.problem = "it needs the function " + symbol + ", which no library here has";
    attempt.advice = "Install the library that has " + symbol +
                     " (for wgetch: ncurses), or name it in LD_PRELOAD.";
  } else if (message.find("cannot open shared object file") == std::string::npos) {
    attempt.problem = "it cannot be loaded (" + message + ")";
    attempt.advice = "Install the vendor's 64-bit library for this system again.";
  } else if (const std::string file = fileNamedBy(message); file != name) {
    attempt.problem = "it needs " + file + ", which is not installed";
    attempt.advice = "Install " + file + " (part of the vendor's device driver), then try again.";
  } else {
    attempt.problem = "no such file";
  }
  return attempt;
}

/// The vendor's library uses ncurses without asking for it; without it loading fails.
void provideNcurses() {
  for (const char* name : {"libncurses.so.5", "libncurses.so.6"})
    if (dlopen(name, RTLD_NOW | RTLD_GLOBAL) != nullptr) return;
}

/// RTLD_NOW: a function missing deep inside must be found here, not end the program at its first
/// call. RTLD_GLOBAL: the vendor's libraries find each other through the global names.
void* openNow(const std::string& name, std::string& message) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    dlerror();
    if (void* handle = dlopen(name.c_str(), RTLD_NOW | RTLD_GLOBAL)) return handle;
    const char* said = dlerror();
    message = said != nullptr ? said : "the loader gave no reason";
    if (symbolNamedBy(message).empty()) return nullptr;
    if (attempt == 0) provideNcurses();
  }
  return nullptr;
}

/// The names of functions that `handle` lacks.
std::string resolve(void* handle, Api& api) {
  std::string missing;
  const auto take = [&](const char* name, auto& slot) {
    void* found = dlsym(handle, name);
    if (found == nullptr) missing += (missing.empty() ? "" : ", ") + std::string(name);
    slot = reinterpret_cast<std::remove_reference_t<decltype(slot)>>(found);
  };
  take("hdInitDevice", api.initDevice);
  take("hdDisableDevice", api.disableDevice);
  take("hdMakeCurrentDevice", api.makeCurrentDevice);
  take("hdBeginFrame", api.beginFrame);
  take("hdEndFrame", api.endFrame);
  take("hdGetError", api.getError);
  take("hdGetErrorString", api.getErrorString);
  take("hdEnable", api.enable);
  take("hdDisable", api.disable);
  take("hdGetBooleanv", api.getBooleanv);
  take("hdGetIntegerv", api.getIntegerv);
  take("hdGetDoublev", api.getDoublev);
  take("hdSetDoublev", api.setDoublev);
  take("hdGetString", api.getString);
  take("hdCheckCalibration", api.checkCalibration);
  take("hdUpdateCalibration", api.updateCalibration);
  take("hdStartScheduler", api.startScheduler);
  take("hdStopScheduler", api.stopScheduler);
  take("hdSetSchedulerRate", api.setSchedulerRate);
  take("hdScheduleAsynchronous", api.scheduleAsynchronous);
  take("hdUnschedule", api.unschedule);
  return missing;
}

std::string resolvedPath(void* handle, const std::string& name) {
  link_map* map = nullptr;
  if (dlinfo(handle, RTLD_DI_LINKMAP, &map) != 0 || map == nullptr) return name;
  return map->l_name != nullptr && *map->l_name != '\0' ? map->l_name : name;
}

/// Never freed, and no handle is ever closed.
struct Loaded {
  std::mutex mutex;
  std::map<void*, std::unique_ptr<Library>> libraries;
};
Loaded& loaded() {
  static Loaded* const all = new Loaded;
  return *all;
}

const Library* load(const std::string& name, LibraryAttempt& attempt) {
  attempt = {name, {}, {}};
  std::string message;
  void* handle = openNow(name, message);
  if (handle == nullptr) {
    attempt = explain(name, message);
    return nullptr;
  }
  const std::lock_guard lock(loaded().mutex);
  auto& slot = loaded().libraries[handle];
  if (!slot) slot = std::make_unique<Library>();
  if (!slot->path.empty()) return slot.get();
  if (const std::string missing = resolve(handle, slot->api); !missing.empty()) {
    attempt.problem = "it lacks " + missing;
    attempt.advice = "Install OpenHaptics 3.0 or later.";
    return nullptr;
  }
  slot->path = resolvedPath(handle, name);
  return slot.get();
}

}  // namespace

std::vector<std::string> libraryCandidates() {
  std::vector<std::string> names;
  if (const char* chosen = std::getenv("PALPATE_HD_LIBRARY"); chosen != nullptr && *chosen != '\0')
    names.emplace_back(chosen);
  names.insert(names.end(), {"libHD.so", "libHD.so.3.4.0", "libHD.so.3.0.0"});
  return names;
}

LibrarySearch findLibrary(const std::vector<std::string>& candidates) {
  LibrarySearch search;
  for (const std::string& name : candidates) {
    search.library = load(name, search.attempts.emplace_back());
    if (search.library != nullptr) break;
  }
  return search;
}

Error libraryError(const LibrarySearch& search) {
  std::string tried, advice;
  for (const LibraryAttempt& attempt : search.attempts) {
    tried += (tried.empty() ? "" : "; ") + attempt.name + ": " + attempt.problem;
    if (advice.empty()) advice = attempt.advice;
  }
  if (advice.empty())
    advice =
        "Install the vendor's OpenHaptics library and device driver, or set PALPATE_HD_LIBRARY to "
        "the path of libHD.so; a simulated device needs neither.";
  return machineError("The Phantom's library could not be loaded.")
      .butFound(tried.empty() ? "no name to try" : tried)
      .advise(advice);
}

}  // namespace palpate::hd
