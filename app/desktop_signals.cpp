#include "app/desktop_signals.h"

#include <csignal>
#include <ctime>

#include <array>
#include <atomic>

namespace palpate {
namespace {

constexpr std::array kAsk{SIGTERM, SIGINT, SIGHUP};
constexpr std::array kCrash{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::atomic<Runner*> guarded{nullptr};
std::atomic<bool> asked{false};
std::array<struct sigaction, kAsk.size() + kCrash.size()> before;
// A crash of the stack itself needs another stack; fixed, because the handler may not allocate.
std::array<char, 65536> otherStack;

void forceOffNow() noexcept {
  // One atomic store inside: safe in a handler (Runner::forceOff).
  if (Runner* runner = guarded.load(std::memory_order_acquire); runner != nullptr) {
    runner->forceOff();
  }
}

void onAsk(int) {
  forceOffNow();
  asked.store(true, std::memory_order_release);
}

void onCrash(int signal) {
  forceOffNow();
  // Twenty servo periods: the zero force is on its way to the device.
  const timespec wait{0, 20'000'000};
  ::nanosleep(&wait, nullptr);
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

DesktopSignals::DesktopSignals() {
  asked.store(false);
  stack_t stack{};
  stack.ss_sp = otherStack.data();
  stack.ss_size = otherStack.size();
  ::sigaltstack(&stack, nullptr);
  std::size_t at = 0;
  const auto install = [&at](int signal, void (*handler)(int), int flags) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = flags;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, &before[at++]);
  };
  for (const int signal : kAsk) install(signal, onAsk, SA_RESTART);
  for (const int signal : kCrash) install(signal, onCrash, SA_ONSTACK);
}

DesktopSignals::~DesktopSignals() {
  std::size_t at = 0;
  for (const int signal : kAsk) ::sigaction(signal, &before[at++], nullptr);
  for (const int signal : kCrash) ::sigaction(signal, &before[at++], nullptr);
  guarded.store(nullptr);
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  ::sigaltstack(&none, nullptr);
}

void DesktopSignals::guard(Runner* runner) noexcept {
  guarded.store(runner, std::memory_order_release);
}

bool DesktopSignals::askedToClose() noexcept {
  return asked.load(std::memory_order_acquire);
}

}  // namespace palpate
