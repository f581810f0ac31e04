#pragma once
/// Counts in sentences.

#include <cstddef>
#include <string>

namespace palpate {

/// "1 copy", "3 copies".
inline std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace palpate
