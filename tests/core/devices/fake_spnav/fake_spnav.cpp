/// A stand-in for libspnav 1.0, loaded by dlopen only: its four functions as Palpate uses them,
/// over a socket pair, and a few of the test's own.

#include <spnav.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>

namespace {
std::atomic<bool> running{true};
std::atomic<int> ours{-1}, theirs{-1};  // the program's end, the service's
}  // namespace

extern "C" {

int spnav_open(void) {
  if (!running.load()) return -1;
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair) != 0) return -1;
  ours = pair[0];
  theirs = pair[1];
  return 0;
}

int spnav_close(void) {
  ::close(ours);
  if (theirs >= 0) ::close(theirs);
  ours = theirs = -1;
  return 0;
}

int spnav_fd(void) {
  return ours;
}

int spnav_poll_event(spnav_event* event) {
  const auto got = ::recv(ours, event, sizeof *event, MSG_DONTWAIT);
  return got == static_cast<long>(sizeof *event) ? event->type : 0;
}

void fake_spnav_send(const spnav_event* event) {
  (void)::send(theirs, event, sizeof *event, MSG_NOSIGNAL);
}

/// The service stops (0) or can be reached again (1).
void fake_spnav_run(int yes) {
  running.store(yes != 0);
  if (yes == 0 && theirs >= 0) {
    ::close(theirs);
    theirs = -1;
  }
}

}  // extern "C"
