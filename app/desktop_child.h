#pragma once
/// A child process of the program itself: `palpate import`, `palpate series`.

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"

namespace palpate {

/// Runs `program arguments...`, reads `progress <fraction> <text>` lines from its stderr and
/// returns its stdout (one JSON object). Cancelling sends SIGTERM, after 3 s SIGKILL. A child that
/// fails gives the error it printed; one that dies without a word gives a sentence. Any thread.
[[nodiscard]] Result<std::string> runChild(const std::string& program,
                                           const std::vector<std::string>& arguments,
                                           const Progress& progress);

}  // namespace palpate
