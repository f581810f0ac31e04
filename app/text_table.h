#pragma once
/// Columns for a terminal: what a command prints without --json.

#include <string>
#include <vector>

namespace palpate {

class TextTable {
 public:
  explicit TextTable(std::vector<std::string> heading) : rows_{std::move(heading)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  /// Columns two spaces apart, each as wide as its widest cell; no space at a line's end.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// `digits` after the point; "-" for what is not finite.
[[nodiscard]] std::string decimal(double value, int digits);
/// 1.5 KiB, 12 MiB.
[[nodiscard]] std::string byteSize(std::size_t bytes);

}  // namespace palpate
