#pragma once
/// How a cost grows: y = a · x^exponent, fitted on logarithms by least squares.

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

struct Growth {
  std::string what, over;  ///< "time a query", "contacts"
  double exponent = 0.0;
  /// Of the exponent, 95 % confidence by Student's t; both infinite with fewer than three points.
  double low = 0.0, high = 0.0;
  std::size_t points = 0;
};

/// Pairs that are not above zero are left out. Refuses nothing: without two different x the
/// exponent is not a number.
[[nodiscard]] Growth fitGrowth(std::string what, std::string over, const std::vector<double>& x,
                               const std::vector<double>& y);

}  // namespace palpate
