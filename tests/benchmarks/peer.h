#pragma once
/// One way to answer the question of a step: which shell points are inside, how deep, which way
/// out.

#include <Eigen/Geometry>
#include <cstddef>
#include <string>

#include "tests/benchmarks/contact_list.h"

namespace palpate::bench {

/// Made ready at construction; find() neither allocates nor keeps anything from step to step
/// unless reset() forgets it.
class Peer {
 public:
  virtual ~Peer() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// What the answer is, where it is not the distance leaf's contact list; empty otherwise.
  [[nodiscard]] virtual std::string remark() const { return {}; }
  /// Bytes of the world's structure (the shell's is small beside it and alike).
  [[nodiscard]] virtual std::size_t worldBytes() const = 0;
  /// Sphere and point tests of the last step, 0 where the peer does not count.
  [[nodiscard]] virtual std::size_t tests() const { return 0; }
  virtual void reset() {}
  /// @param X_VT  p_V = X_VT * p_T, metres.
  virtual void find(const Eigen::Isometry3d& X_VT, ContactList& out) = 0;
  /// Where find() answers in a form of its own and sets only out.count: fills the rest, untimed.
  virtual void collect(ContactList& /*out*/) const {}
};

}  // namespace palpate::bench
