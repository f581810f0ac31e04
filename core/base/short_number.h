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

/// One number in a format of printf's, up to 63 characters: "%.2f mm".
inline std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace palpate
