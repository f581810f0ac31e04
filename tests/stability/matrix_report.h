#pragma once
/// The table and the maps of the matrix: what ran, how it was judged, as CSV and SVG.

#include <string>
#include <vector>

#include "tests/stability/verdict.h"

namespace palpate::stability {

/// The whole matrix (label stability-full), or the part that always runs.
#ifdef PALPATE_WHOLE_MATRIX
inline constexpr bool kWhole = true;
#else
inline constexpr bool kWhole = false;
#endif

struct Row {
  std::string name;  ///< What varies, in words.
  double x = 0.0, y = 0.0;
  Judged judged;
};

struct MapAxes {
  std::string title, x, y;  ///< "Stiffness and delay", "K (N/m)", "extra delay (ms)"
};

/// Writes FAMILY.csv and, where axes are given, FAMILY.svg into the folder named by
/// PALPATE_STABILITY_OUT, else `stability-results` in the folder the test runs in. Several rows of
/// one place of the map show as the worst of them. Prints a line of totals.
void report(const std::string& family, const std::vector<Row>& rows, const MapAxes* axes = nullptr);

}  // namespace palpate::stability
