#include "core/devices/space_mouse.h"

#include <poll.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "core/devices/shared_library.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

// libspnav's interface as we use it; our own declarations, checked by the tests' fake library and,
// on Debian, against the header of libspnav-dev 1.0.
struct MotionEvent {
  int type;
  int x, y, z, rx, ry, rz;
  unsigned int period;
  int* data;
};
struct ButtonEvent {
  int type;
  int press, number;
};
union Event {
  int type;
  MotionEvent motion;
  ButtonEvent button;
};
static_assert(sizeof(Event) == 40, "the size of libspnav's event on 64-bit systems");
constexpr int kMotion = 1, kButton = 2;

struct Api {
  int (*open)() = nullptr;
  int (*close)() = nullptr;
  int (*poll)(Event*) = nullptr;
  int (*fd)() = nullptr;  ///< The socket to the service.
  std::string path;
};

struct Found {
  const Api* api = nullptr;
  std::string tried;
};

std::vector<std::string> candidates(const SpaceMouseOptions& options) {
  std::vector<std::string> names;
  if (const char* chosen = std::getenv("PALPATE_SPNAV_LIBRARY");
      chosen != nullptr && *chosen != '\0') {
    names.emplace_back(chosen);
  }
  names.insert(names.end(), options.libraries.begin(), options.libraries.end());
  return names;
}

template <class Function>
bool take(void* library, const char* name, Function& slot) {
  slot = reinterpret_cast<Function>(findFunction(library, name));
  return slot != nullptr;
}

/// The library is kept for good, like the vendor's.
Found findApi(const SpaceMouseOptions& options) {
  Found found;
  for (const std::string& name : candidates(options)) {
    std::string message;
    void* library = openLibrary(name, message);
    auto api = std::make_unique<Api>();
    if (library == nullptr) {
      found.tried += (found.tried.empty() ? "" : "; ") + name + ": not there";
    } else if (!take(library, "spnav_open", api->open) ||
               !take(library, "spnav_close", api->close) ||
               !take(library, "spnav_poll_event", api->poll) ||
               !take(library, "spnav_fd", api->fd)) {
      found.tried += (found.tried.empty() ? "" : "; ") + name + ": not a libspnav";
    } else {
      api->path = libraryFile(library, name);
      found.api = api.release();
      return found;
    }
  }
  return found;
}

Error libraryMissing(const Found& found) {
  return machineError("The library of 3D mice (libspnav) could not be loaded.")
      .inField("device")
      .butFound(found.tried)
      .advise("Install it: apt install libspnav0 spacenavd.");
}

Error serviceSilent() {
  return machineError("The service of 3D mice (spacenavd) does not answer.")
      .inField("device")
      .advise("Start it (systemctl start spacenavd) and plug the mouse in.");
}

/// libspnav keeps one connection in a process, in globals of its own: one hand at a time uses it.
std::mutex& connection() {
  static auto* const mutex = new std::mutex;
  return *mutex;
}

class SpaceMouseHand final : public Hand {
 public:
  SpaceMouseHand(const Api& api, const SpaceMouseOptions& options)
      : api_(api), options_(options), wish_(position(stylusAtRest(options.startHeight))) {
    turn_ = orientation(stylusAtRest(options.startHeight));
    thread_ = std::thread([this] { work(); });
  }
  SpaceMouseHand(const SpaceMouseHand&) = delete;
  SpaceMouseHand& operator=(const SpaceMouseHand&) = delete;
  ~SpaceMouseHand() override {
    stopping_.store(true);
    thread_.join();
  }

  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    newest_.refresh();
    const Cap& cap = newest_.value();
    const double dt = started_ ? std::clamp(t - last_, 0.0, 0.1) : 0.0;
    started_ = true;
    last_ = t;
    for (int i = 0; i < 3; ++i) {
      wish_[i] = std::clamp(wish_[i] + dt * cap.v[i], -options_.reach, options_.reach);
    }
    turn_ = (expMap(dt * Eigen::Vector3d(cap.w[0], cap.w[1], cap.w[2])) * turn_).normalized();
    return {plain(wish_, turn_), cap.pressed ? 1u : 0u, true};
  }

 private:
  struct Cap {
    double v[3] = {0, 0, 0}, w[3] = {0, 0, 0};  ///< m/s, rad/s, in D
    bool pressed = false;
  };

  /// Counts to a rate: nothing in the dead zone, then as the square, so that small is fine.
  [[nodiscard]] double rate(int counts, double fastest) const {
    const double u = std::clamp(counts / options_.fullDeflection, -1.0, 1.0);
    const double beyond =
        std::max(0.0, std::abs(u) - options_.deadZone) / (1.0 - options_.deadZone);
    return std::copysign(beyond * beyond * fastest, u);
  }

  void take(const Event& event, Cap& cap) const {
    if (event.type == kButton && event.button.number == 0) cap.pressed = event.button.press != 0;
    if (event.type != kMotion) return;
    // libspnav: x right, y up, z away from the user; D: z towards the user. Turns follow as an
    // axial vector does under that reflection.
    const MotionEvent& m = event.motion;
    cap.v[0] = rate(m.x, options_.fastest);
    cap.v[1] = rate(m.y, options_.fastest);
    cap.v[2] = -rate(m.z, options_.fastest);
    cap.w[0] = -rate(m.rx, options_.fastestTurn);
    cap.w[1] = -rate(m.ry, options_.fastestTurn);
    cap.w[2] = rate(m.rz, options_.fastestTurn);
  }

  void work() {
    while (!stopping_.load()) {
      {
        const std::lock_guard lock(connection());
        if (api_.open() != -1) listen();
      }
      newest_.publish({});  // nobody is there: it stands still, the button let go
      for (int i = 0; i < 50 && !stopping_.load(); ++i) std::this_thread::sleep_for(20ms);
    }
  }

  /// Until the service goes away: then its socket can be read, and there is nothing in it. (A mouse
  /// that lies still sends nothing either, but then the socket cannot be read.)
  void listen() {
    Cap cap;
    while (!stopping_.load()) {
      pollfd socket{api_.fd(), POLLIN, 0};
      if (::poll(&socket, 1, 20) <= 0) continue;
      Event event{};
      if (api_.poll(&event) <= 0) break;
      do {
        take(event, cap);
      } while (api_.poll(&event) > 0);
      newest_.publish(cap);
    }
    api_.close();
  }

  const Api& api_;
  SpaceMouseOptions options_;
  LatestValue<Cap> newest_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
  Eigen::Vector3d wish_;  // servo thread, as the rest
  Eigen::Quaterniond turn_;
  double last_ = 0.0;
  bool started_ = false;
};

bool answers(const Api& api) {
  const std::lock_guard lock(connection());
  if (api.open() == -1) return false;
  api.close();
  return true;
}

}  // namespace

SpaceMouseSearch findSpaceMouse(const SpaceMouseOptions& options) {
  SpaceMouseSearch search;
  const Found found = findApi(options);
  const Error problem = found.api == nullptr ? libraryMissing(found) : serviceSilent();
  search.there = found.api != nullptr && answers(*found.api);
  if (found.api != nullptr) search.library = found.api->path;
  search.note = search.there ? "Gives no force: what would be felt is drawn." : problem.message;
  if (!search.there) search.advice = problem.advice.value_or("");
  return search;
}

Result<std::shared_ptr<Hand>> makeSpaceMouseHand(const SpaceMouseOptions& options) {
  const Found found = findApi(options);
  if (found.api == nullptr) return fail(libraryMissing(found));
  if (!answers(*found.api)) return fail(serviceSilent());
  return std::shared_ptr<Hand>(std::make_shared<SpaceMouseHand>(*found.api, options));
}

}  // namespace palpate
