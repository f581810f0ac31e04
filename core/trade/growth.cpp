#include "core/trade/growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// Student's t, two-sided 95 %, by degrees of freedom from 1; beyond the table close to normal.
double studentsT(std::size_t freedom) {
  constexpr std::array<double, 30> kTable{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306,
                                          2.262,  2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
                                          2.110,  2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064,
                                          2.060,  2.056, 2.052, 2.048, 2.045, 2.042};
  if (freedom <= kTable.size()) return kTable[freedom - 1];
  return 1.960 + 2.4 / static_cast<double>(freedom);
}

}  // namespace

Growth fitGrowth(std::string what, std::string over, const std::vector<double>& x,
                 const std::vector<double>& y) {
  Growth growth;
  growth.what = std::move(what);
  growth.over = std::move(over);
  std::vector<double> u, v;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (!(x[i] > 0.0 && y[i] > 0.0)) continue;
    u.push_back(std::log(x[i]));
    v.push_back(std::log(y[i]));
  }
  growth.points = u.size();
  const auto n = static_cast<double>(u.size());
  double meanU = 0.0, meanV = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    meanU += u[i] / n;
    meanV += v[i] / n;
  }
  for (std::size_t i = 0; i < u.size(); ++i) {
    uu += (u[i] - meanU) * (u[i] - meanU);
    uv += (u[i] - meanU) * (v[i] - meanV);
    vv += (v[i] - meanV) * (v[i] - meanV);
  }
  growth.exponent = uu > 0.0 ? uv / uu : std::numeric_limits<double>::quiet_NaN();
  double half = std::numeric_limits<double>::infinity();
  if (u.size() > 2 && uu > 0.0) {
    const double residual = std::max(vv - growth.exponent * uv, 0.0);
    half = studentsT(u.size() - 2) * std::sqrt(residual / (n - 2.0) / uu);
  }
  growth.low = growth.exponent - half;
  growth.high = growth.exponent + half;
  return growth;
}

}  // namespace palpate
