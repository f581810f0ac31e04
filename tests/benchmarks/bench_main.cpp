/// palpate_bench: `palpate_bench peers ...` runs the peers side by side; anything else is Google
/// Benchmark's main. Both say first which machine, build and commit it was.

#include <benchmark/benchmark.h>

#include <string_view>

#include "tests/benchmarks/machine.h"
#include "tests/benchmarks/peers_main.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "peers") {
    return palpate::bench::runPeers(argc - 1, argv + 1);
  }
  benchmark::AddCustomContext("processor", palpate::bench::processorName());
  benchmark::AddCustomContext("build", palpate::bench::buildName());
  benchmark::AddCustomContext("commit", palpate::bench::commitName());
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
