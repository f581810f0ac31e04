#pragma once
/// The header of a PLY file, as far as a point shell needs it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace palpate {

enum class PlyType : std::uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

[[nodiscard]] std::size_t plyBytes(PlyType type) noexcept;

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<std::pair<std::string, PlyType>> properties;
  bool hasList = false;
  /// Bytes of one row in a binary file; meaningless with a list.
  [[nodiscard]] std::size_t rowBytes() const noexcept;
};

struct PlyHeader {
  bool binary = false;
  std::vector<PlyElement> elements;
  std::size_t lines = 0;   ///< Of the header.
  std::string_view body;   ///< What follows it.
  std::size_t vertex = 0;  ///< Which element is `vertex`.
  /// Where x, y, z, nx, ny, nz are among its properties.
  std::array<std::size_t, 6> columns{};
};

/// Refuses by line what is not a PLY 1.0 header with a usable vertex element.
[[nodiscard]] Result<PlyHeader> parsePlyHeader(std::string_view bytes, const std::string& name);

}  // namespace palpate
