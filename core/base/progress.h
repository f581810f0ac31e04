#pragma once
/// Progress and cancel for anything that may take over half a second.

#include <atomic>
#include <functional>
#include <string>

namespace palpate {

/// Asked for by one thread, seen by another. Outlives the work it stops.
class CancelToken {
 public:
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool cancelled() const noexcept {
    return cancelled_.load(std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> cancelled_{false};
};

/// Handed by const reference to long work. Called on a thread that works, one at a time; `report`
/// must be cheap and must not throw. The default reports nowhere and never cancels.
struct Progress {
  std::function<void(double fraction, const std::string& what)> report;  ///< fraction in [0, 1]
  const CancelToken* cancel = nullptr;

  void operator()(double fraction, const std::string& what) const {
    if (report) report(fraction, what);
  }
  [[nodiscard]] bool cancelled() const noexcept { return cancel != nullptr && cancel->cancelled(); }
};

}  // namespace palpate
