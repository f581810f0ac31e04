#include "core/devices/hdapi.h"

#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>

#include "core/devices/shared_library.h"

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

/// The vendor's library for Linux uses ncurses without asking for it; without it loading fails.
void provideNcurses() {
  std::string message;
  for (const char* name : {"libncurses.so.5", "libncurses.so.6"})
    if (openLibrary(name, message) != nullptr) return;
}

void* openNow(const std::string& name, std::string& message) {
  if (void* handle = openLibrary(name, message)) return handle;
  if (symbolNamedBy(message).empty()) return nullptr;
  provideNcurses();
  return openLibrary(name, message);
}

/// The names of functions that `handle` lacks.
std::string resolve(void* handle, Api& api) {
  std::string missing;
  const auto take = [&](const char* name, auto& slot) {
    void* found = findFunction(handle, name);
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
  slot->path = libraryFile(handle, name);
  return slot.get();
}

}  // namespace

std::vector<std::string> libraryCandidates() {
  std::vector<std::string> names;
  if (const char* chosen = std::getenv("PALPATE_HD_LIBRARY"); chosen != nullptr && *chosen != '\0')
    names.emplace_back(chosen);
#if defined(_WIN32)
  names.emplace_back("HD.dll");
#elif defined(__APPLE__)
  names.emplace_back("libHD.dylib");
#else
  names.insert(names.end(), {"libHD.so", "libHD.so.3.4.0", "libHD.so.3.0.0"});
#endif
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
