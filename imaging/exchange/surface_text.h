#pragma once
/// Words and numbers out of the text of a surface file, without a copy.

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace palpate {

/// Takes the next word from the front of `text`; empty at its end.
inline std::string_view takeWord(std::string_view& text) {
  constexpr std::string_view kBlank = " \t\r\n\f\v";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlank));
  text.remove_prefix(word.size());
  return word;
}

/// Takes the next line from the front of `text`, without its end.
inline std::string_view takeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// The whole word as a number; from_chars knows no plus sign.
template <class Number>
std::optional<Number> numberFrom(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace palpate
