#include "tests/benchmarks/machine.h"

#include <fstream>

#ifndef PALPATE_BENCH_COMMIT
#define PALPATE_BENCH_COMMIT "unknown"
#endif

namespace palpate::bench {

std::string processorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

std::string buildName() {
#ifdef NDEBUG
  return "release, " __VERSION__;
#else
  return "with assertions, " __VERSION__;
#endif
}

std::string commitName() {
  return PALPATE_BENCH_COMMIT;
}

}  // namespace palpate::bench
