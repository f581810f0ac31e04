#pragma once
/// What can be promised of motions that were not measured.

#include <vector>

namespace palpate {

/// An upper bound of a percentile over as many other motions of the same kind. Motions are drawn
/// with replacement twice: once for what the measured ones do not tell of all there are, and from
/// these again for what another handful would differ by; 39 of 40 such draws lie below. Motions,
/// not values, are drawn, since values of one motion are alike. A tenth more holds 19 times in 20
/// for 50 motions whose levels differ by some half; where a few motions decide, less often (README,
/// "Speed against accuracy": what was seen). The same values give the same bound. 0 of nothing.
[[nodiscard]] double boundOf(const std::vector<std::vector<double>>& valuesByMotion, double share);

}  // namespace palpate
