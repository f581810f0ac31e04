#pragma once
/// Times peers on one trajectory in turn, so that what the machine does meanwhile meets all alike.

#include <memory>
#include <vector>

#include "tests/benchmarks/peer.h"
#include "tests/benchmarks/trajectory.h"

namespace palpate::bench {

struct Timing {
  double p50 = 0,
         p99 = 0;       ///< Microseconds over the steps; a step's time is its median over passes.
  double worst = 0;     ///< The slowest step by that measure.
  double worstRaw = 0;  ///< The slowest single call, the machine's interruptions included.
  double p50Touching = 0;  ///< Median over the steps with contacts.
  double contacts = 0;     ///< Median over the steps with contacts.
  std::size_t maxContacts = 0;
  double tests = 0;  ///< Mean a step.
};

/// One entry a peer, in order. `capacity` is the number of shell points.
[[nodiscard]] std::vector<Timing> timePeers(const std::vector<std::unique_ptr<Peer>>& peers,
                                            const Trajectory& trajectory, std::size_t capacity,
                                            int passes);

struct Agreement {
  std::size_t steps = 0, differentSteps = 0, differentPoints = 0;
  double deepestDifferent = 0;  ///< Depth of a point that only one of the two has, voxels.
  double depthError = 0;        ///< Largest |difference| of depth, voxels.
  double normalError = 0;       ///< Largest angle, radians, over contacts deeper than 0.01 voxel.
};

/// Compares contact lists by point, over every `stride`-th step.
[[nodiscard]] Agreement compare(Peer& reference, Peer& peer, const Trajectory& trajectory,
                                std::size_t capacity, std::size_t stride);

}  // namespace palpate::bench
