#pragma once
/// What can be promised of motions that were not measured.

#include <vector>

namespace palpate {

/// An upper bound of a percentile: that of the pooled values of motions drawn with replacement, 400
/// times; 95 of 100 draws lie below. Motions, not values, are drawn, since values of one motion are
/// alike. The same values give the same bound. 0 of nothing.
[[nodiscard]] double boundOf(const std::vector<std::vector<double>>& valuesByMotion, double share);

}  // namespace palpate
