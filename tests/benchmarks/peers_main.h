#pragma once
/// palpate_bench without Google Benchmark's options: the peers side by side.

namespace palpate::bench {

/// @return exit code; 2 for a wrong argument, with a line on stderr.
int runPeers(int argc, char** argv);

}  // namespace palpate::bench
