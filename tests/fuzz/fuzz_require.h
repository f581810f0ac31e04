#pragma once
/// What must hold for any input; libFuzzer keeps the input that breaks it.

#include <cstdio>
#include <cstdlib>

namespace palpate {

inline void require(bool holds, const char* claim) {
  if (holds) return;
  std::fprintf(stderr, "Broken: %s\n", claim);
  std::abort();
}

}  // namespace palpate
