#include "app/process_guard.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <mutex>
#include <thread>

namespace palpate {
namespace {

constexpr int kExitCancelled = 5;
constexpr int kExitMachine = 4;
constexpr std::chrono::seconds kGrace{5};  // for a loop that looks at its token seldom

CancelToken cancelToken;
std::atomic<bool> signalSeen{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void onStopSignal(int) {
  if (signalSeen.exchange(true)) {
    constexpr char text[] = "\nCancelled.\n";
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, sizeof text - 1);
    ::_exit(kExitCancelled);
  }
  cancelToken.cancel();
}

}  // namespace

void protectProcess() {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
  ::umask(S_IRWXG | S_IRWXO);
  std::signal(SIGPIPE, SIG_IGN);
}

const CancelToken& cancelOnSignals() {
  struct sigaction action {};
  action.sa_handler = &onStopSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  return cancelToken;
}

struct LimitGuard::Watch {
  double seconds = 0.0;
  std::atomic<bool> up{false};
  std::mutex mutex;
  std::condition_variable done;
  bool finished = false;
  std::thread thread;

  [[nodiscard]] Error error() const {
    return machineError("The command took longer than its limit of " +
                        std::to_string(std::lround(seconds)) + " s and was stopped.")
        .advise("Nothing was written; give it more time, or a smaller input.");
  }

  void run() {
    std::unique_lock lock(mutex);
    const auto until = std::chrono::duration<double>(seconds);
    if (done.wait_for(lock, until, [this] { return finished; })) return;
    up.store(true);
    cancelToken.cancel();
    if (done.wait_for(lock, kGrace, [this] { return finished; })) return;
    const std::string text = "\n" + sentence(error()) + "\n";
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    ::_exit(kExitMachine);
  }
};

LimitGuard::LimitGuard(const ProcessLimits& limits) : watch_(std::make_unique<Watch>()) {
  if (limits.memoryMiB > 0) {
    // Data, not address space: the libraries and the threads' reserved arenas are not memory used.
    const rlim_t bytes = limits.memoryMiB * 1024 * 1024;
    const rlimit data{bytes, bytes};
    ::setrlimit(RLIMIT_DATA, &data);
  }
  if (limits.seconds > 0.0) {
    watch_->seconds = limits.seconds;
    watch_->thread = std::thread([watch = watch_.get()] { watch->run(); });
  }
}

LimitGuard::~LimitGuard() {
  if (!watch_->thread.joinable()) return;
  {
    const std::lock_guard lock(watch_->mutex);
    watch_->finished = true;
  }
  watch_->done.notify_all();
  watch_->thread.join();
}

bool LimitGuard::timeIsUp() const noexcept {
  return watch_->up.load();
}

Error LimitGuard::timeError() const {
  return watch_->error();
}

}  // namespace palpate
