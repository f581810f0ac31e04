#pragma once
/// Does the prototype give the same bits with and without its trees, at every SIMD width?

#include "tests/benchmarks/prototype/prototype.h"
#include "tests/benchmarks/trajectory.h"

namespace palpate::bench {

/// Compares whole lists bit by bit over every `stride`-th pose; prints a line a target.
/// @return number of lists that differ.
std::size_t checkIdentity(const FastWorld& world, const ProbeTree& probe,
                          const Trajectory& trajectory, std::size_t stride);

}  // namespace palpate::bench
