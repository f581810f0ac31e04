#include "app/desktop.h"

#include <cstdio>

#include "app/desktop_loop.h"

namespace palpate {
namespace {

int leave(const Error& error) {
  std::fprintf(stderr, "%s\n", sentence(error).c_str());
  return exitCode(error.kind);
}

}  // namespace

int runDesktop(const DesktopOptions& options) {
  auto desktop = Desktop::open(options);
  if (!desktop) return leave(desktop.error());
  const Result<void> done = options.screenshot ? (*desktop)->renderPicture() : (*desktop)->run();
  return done ? 0 : leave(done.error());
}

}  // namespace palpate
