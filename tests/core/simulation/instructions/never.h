#pragma once
/// What stands in the place of an effect in a build that never had it: the compiler sees that it is
/// not there, and leaves out all that is done about it. The declarations that CMakeLists.txt names
/// get these types; the sources are the program's own.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpate {

/// A number that is always 0.
struct Never {
  constexpr Never() = default;
  constexpr Never(double) noexcept {}  // NOLINT: stands in for a double
  constexpr operator double() const noexcept { return 0.0; }
};

/// A list that is always empty.
template <class T>
struct NoneOf {
  NoneOf() = default;
  NoneOf(std::vector<T>&&) noexcept {}  // NOLINT
  [[nodiscard]] static constexpr std::size_t size() noexcept { return 0; }
  [[nodiscard]] static constexpr T* begin() noexcept { return nullptr; }
  [[nodiscard]] static constexpr T* end() noexcept { return nullptr; }
  [[nodiscard]] T& operator[](std::size_t) const noexcept { return *begin(); }
  operator std::span<const T>() const noexcept { return {}; }  // NOLINT
};

/// A list that always has one.
template <class T>
struct OneOf {
  OneOf() = default;
  explicit OneOf(std::size_t) : one(T{}) {}
  void reserve(std::size_t) noexcept {}
  void push_back(T&& value) { one.emplace(std::move(value)); }
  [[nodiscard]] static constexpr std::size_t size() noexcept { return 1; }
  [[nodiscard]] T* begin() noexcept { return &*one; }
  [[nodiscard]] T* end() noexcept { return &*one + 1; }
  [[nodiscard]] const T* begin() const noexcept { return &*one; }
  [[nodiscard]] const T* end() const noexcept { return &*one + 1; }
  [[nodiscard]] T& operator[](std::size_t) noexcept { return *one; }
  [[nodiscard]] const T& operator[](std::size_t) const noexcept { return *one; }

  std::optional<T> one;
};

}  // namespace palpate
