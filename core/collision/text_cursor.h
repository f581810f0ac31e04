#pragma once
/// Lines and numbers of a text that a person may have written: no locale, no surprise.

#include <charconv>
#include <optional>
#include <string_view>

namespace palpate {

/// Reads line by line; counts from 1. Takes \n and \r\n.
class LineReader {
 public:
  explicit LineReader(std::string_view text) noexcept : rest_(text) {}

  [[nodiscard]] std::optional<std::string_view> next() noexcept {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return line;
  }
  [[nodiscard]] std::size_t number() const noexcept { return number_; }
  /// What follows the last line.
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

[[nodiscard]] inline std::string_view trimmed(std::string_view text) noexcept {
  constexpr std::string_view kBlank = " \t";
  const std::size_t from = text.find_first_not_of(kBlank);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(kBlank) - from + 1);
}

/// Takes the next word off the front; empty at the end.
[[nodiscard]] inline std::string_view takeWord(std::string_view& line) noexcept {
  line = trimmed(line);
  const std::size_t end = line.find_first_of(" \t");
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(word.size());
  return word;
}

/// The whole text as a number, or nothing.
template <class T>
[[nodiscard]] std::optional<T> numberOf(std::string_view text) noexcept {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace palpate
