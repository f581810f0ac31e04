#include "app/desktop.h"

#include <cstdio>

namespace palpate {

int runDesktop(const DesktopOptions&) {
  std::fputs("The window is not part of this build yet.\n", stderr);
  return 4;
}

}  // namespace palpate
