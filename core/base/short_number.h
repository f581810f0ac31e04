#pragma once
/// Numbers in sentences.

#include <cstdio>
#include <string>

namespace palpate {

/// Six significant digits: "226", "0.957031", "1e+06".
inline std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace palpate
