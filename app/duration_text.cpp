#include "app/duration_text.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace palpate {

Result<double> parseDuration(const std::string& text, const std::string& option) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, number);
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  double factor = 0.0;
  if (unit == "s") factor = 1.0;
  if (unit == "ms") factor = 1e-3;
  if (unit == "us" || unit == "µs") factor = 1e-6;
  if (code == std::errc() && factor > 0.0 && std::isfinite(number) && number > 0.0) {
    return number * factor;
  }
  return fail(usageError("The duration is not one.")
                  .inField(option)
                  .butFound(text)
                  .wants("a number with its unit, such as 1ms, 500us or 0.001s")
                  .advise("Write the unit behind the number."));
}

}  // namespace palpate
