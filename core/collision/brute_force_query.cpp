/// QueryMethod::BruteForce: every point to the leaf test.

#include "core/collision/query_work.h"

namespace palpate {

template <int Bits>
void runBruteForce(QueryWork& work) noexcept {
  PointSink<Bits> sink(work);
  const auto count = static_cast<std::uint32_t>(work.shell->size());
  for (std::uint32_t rank = 0; rank < count; ++rank) sink.offer(rank);
}

template void runBruteForce<1>(QueryWork&) noexcept;
template void runBruteForce<2>(QueryWork&) noexcept;
template void runBruteForce<3>(QueryWork&) noexcept;

}  // namespace palpate
