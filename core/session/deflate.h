#pragma once
/// zlib, for the label volume that a session carries.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpate {

[[nodiscard]] std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes);
/// Nothing unless the data inflates to exactly `size` bytes.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> inflated(std::span<const std::uint8_t> bytes,
                                                                std::size_t size);

}  // namespace palpate
