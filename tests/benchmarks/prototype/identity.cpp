#include "tests/benchmarks/prototype/identity.h"

#include <hwy/targets.h>

#include <cstdio>
#include <cstring>

namespace palpate::bench {
namespace {

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b, std::size_t count) {
  return std::memcmp(a.data(), b.data(), count * sizeof(T)) == 0;
}

bool same(const ContactList& a, const ContactList& b) {
  return a.count == b.count && sameBits(a.index, b.index, a.count) &&
         sameBits(a.depth, b.depth, a.count) && sameBits(a.nx, b.nx, a.count) &&
         sameBits(a.ny, b.ny, a.count) && sameBits(a.nz, b.nz, a.count);
}

}  // namespace

std::size_t checkIdentity(const FastWorld& world, const ProbeTree& probe,
                          const Trajectory& trajectory, std::size_t stride) {
  const auto every = makePrototype(world, probe, true);
  const auto fast = makePrototype(world, probe);
  std::vector<ContactList> expected;
  for (std::size_t i = 0; i < trajectory.X_VT.size(); i += stride) {
    expected.emplace_back(probe.leaf.size() * 16);
    every->find(trajectory.X_VT[i], expected.back());
  }
  std::size_t wrong = 0;
  ContactList list(probe.leaf.size() * 16);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    std::size_t different = 0;
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      fast->find(trajectory.X_VT[i * stride], list);
      contacts += list.count;
      if (!same(list, expected[i])) ++different;
    }
    std::printf("  identity %-10s %zu poses, %zu contacts: %zu lists differ from every point's\n",
                hwy::TargetName(target), expected.size(), contacts, different);
    wrong += different;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  return wrong;
}

}  // namespace palpate::bench
