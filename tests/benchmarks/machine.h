#pragma once
/// What every table says first: processor, compiler, build and commit. Never a host's name.

#include <string>

namespace palpate::bench {

[[nodiscard]] std::string processorName();
[[nodiscard]] std::string buildName();
[[nodiscard]] std::string commitName();

}  // namespace palpate::bench
