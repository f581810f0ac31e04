#pragma once
/// The fast design, tried out: clearances and coded bricks on the nodes of a 64-ary tree.

#include <memory>

#include "tests/benchmarks/dense_field.h"
#include "tests/benchmarks/peer.h"
#include "tests/benchmarks/probe_tree.h"

namespace palpate::bench {

struct FastWorld;
struct FastWorldDeleter {
  void operator()(FastWorld* world) const;
};
using FastWorldPointer = std::unique_ptr<FastWorld, FastWorldDeleter>;

[[nodiscard]] FastWorldPointer prototypeWorld(const DenseField& field);
/// `everyPoint`: without the probe's tree, the same arithmetic for all points.
[[nodiscard]] std::unique_ptr<Peer> makePrototype(const FastWorld& world, const ProbeTree& probe,
                                                  bool everyPoint = false);

}  // namespace palpate::bench
