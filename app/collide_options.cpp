#include "app/collide_options.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "core/geometry/units.h"

namespace palpate {
namespace {

constexpr const char* kKeys =
    "surface_only, tight_spheres, one_child_skip, side_offset, coherence (on or off), stop_level, "
    "contact_budget (whole numbers), perceptual_mm (a length)";

std::optional<bool> switchOf(std::string_view text) {
  for (const std::string_view on : {"on", "true", "yes", "1"}) {
    if (text == on) return true;
  }
  for (const std::string_view off : {"off", "false", "no", "0"}) {
    if (text == off) return false;
  }
  return std::nullopt;
}

// As in the scene file: ten centimetres are more than any instrument that is felt.
constexpr double kMostPerceptual_mm = 100.0;

template <class T>
std::optional<T> numberOf(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool* switchNamed(std::string_view key, TreeOptions& tree, QueryOptions& query) {
  if (key == "surface_only") return &tree.surfaceOnly;
  if (key == "tight_spheres") return &query.tightSpheres;
  if (key == "one_child_skip") return &query.oneChildSkip;
  if (key == "side_offset") return &query.sideOffset;
  if (key == "coherence") return &query.coherence;
  return nullptr;
}

Error unknown(const std::string& option, const char* what) {
  return usageError(std::string("The option's ") + what + " is not known.")
      .inField("--option")
      .butFound(option)
      .wants(kKeys)
      .advise("Give --option KEY=VALUE.");
}

Result<void> applyOne(const std::string& option, TreeOptions& tree, QueryOptions& query) {
  const std::size_t equals = option.find('=');
  if (equals == std::string::npos) return fail(unknown(option, "form"));
  const std::string_view key = std::string_view(option).substr(0, equals);
  const std::string_view value = std::string_view(option).substr(equals + 1);
  if (bool* flag = switchNamed(key, tree, query)) {
    const auto on = switchOf(value);
    if (!on) return fail(unknown(option, "value"));
    *flag = *on;
  } else if (key == "stop_level") {
    const auto level = numberOf<int>(value);
    if (!level || *level < 0) return fail(unknown(option, "value"));
    query.stopLevel = *level;
  } else if (key == "contact_budget") {
    const auto budget = numberOf<std::uint32_t>(value);
    if (!budget) return fail(unknown(option, "value"));
    query.contactBudget = *budget;
  } else if (key == "perceptual_mm") {
    const auto bound_mm = numberOf<double>(value);
    if (!bound_mm || !(*bound_mm >= 0.0 && *bound_mm <= kMostPerceptual_mm)) {
      return fail(unknown(option, "value"));
    }
    query.perceptualBound = metres(*bound_mm);
  } else {
    return fail(unknown(option, "key"));
  }
  return {};
}

}  // namespace

Result<void> applyCollideOptions(const std::vector<std::string>& options, TreeOptions& tree,
                                 QueryOptions& query) {
  for (const std::string& option : options) {
    if (auto ok = applyOne(option, tree, query); !ok) return ok;
  }
  return {};
}

}  // namespace palpate
