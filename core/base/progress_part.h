#pragma once
/// Part of a longer piece of work.

#include "core/base/progress.h"

namespace palpate {

/// Its own fractions shown as the share [from, to] of `whole`, which outlives it; cancelled with
/// it.
[[nodiscard]] inline Progress shareOf(const Progress& whole, double from, double to) {
  Progress part;
  part.cancel = whole.cancel;
  if (!whole.report) return part;
  part.report = [&whole, from, to](double fraction, const std::string& what) {
    whole.report(from + (to - from) * fraction, what);
  };
  return part;
}

}  // namespace palpate
