#pragma once
/// Plain data to bytes and back, every bit kept, the same on every machine.
///
/// Little-endian, no padding; doubles as their IEEE bits (SQLite's own REAL turns -0.0 into 0 and
/// NaN into NULL, and a state hash would then differ).

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace palpate {

static_assert(std::endian::native == std::endian::little, "sessions are little-endian");

class Packer {
 public:
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  template <class T, std::size_t n>
  void put(const T (&values)[n]) {
    for (const T& value : values) put(value);
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Reads what a Packer wrote. Past the end, or from bytes that are too few, it gives zeros and
/// ok() turns false: ask once, after the last get.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class T>
  void get(T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    if (!take(sizeof(T))) {
      value = T{};
      return;
    }
    std::memcpy(&value, bytes_.data() + at_ - sizeof(T), sizeof(T));
  }
  template <class T, std::size_t n>
  void get(T (&values)[n]) {
    for (T& value : values) get(value);
  }
  void get(std::string& text) {
    std::uint32_t size = 0;
    get(size);
    text.clear();
    if (!take(size)) return;
    text.assign(reinterpret_cast<const char*>(bytes_.data()) + at_ - size, size);
  }
  /// A count of items that follow, each of at least `itemBytes`: refused if they cannot be there.
  [[nodiscard]] std::size_t count(std::size_t itemBytes) {
    std::uint64_t n = 0;
    get(n);
    if (n > (bytes_.size() - at_) / itemBytes) {
      ok_ = false;
      return 0;
    }
    return static_cast<std::size_t>(n);
  }
  /// Everything was there, and nothing is left over.
  [[nodiscard]] bool finished() const { return ok_ && at_ == bytes_.size(); }

 private:
  bool take(std::size_t size) {
    if (!ok_ || size > bytes_.size() - at_) {
      ok_ = false;
      return false;
    }
    at_ += size;
    return true;
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace palpate
