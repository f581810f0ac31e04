#pragma once
/// What can be set, one option at a time, and the settings that a sweep tries.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace palpate {

/// What a scene can declare, and what only a measurement changes.
struct TradeSetting {
  SimulationSetting simulation;
  int coarsening = 1;            ///< Voxels of the anatomy joined along each axis.
  bool doublePrecision = false;  ///< The reference's own query and loop, with this shell.
};

struct OptionValue {
  std::string name;  ///< "4.00mm", "off"
  std::function<void(TradeSetting&)> apply;
};

/// An option and its values other than the base's own.
struct TradeOption {
  std::string name;  ///< "shell"
  std::vector<OptionValue> values;
};

/// @param spacing  m, of the base's shell.
[[nodiscard]] std::vector<TradeOption> optionsAround(const SimulationSetting& base, double spacing);

struct NamedSetting {
  std::string name;  ///< "default", "shell=1.00mm", "shell=1.00mm leaf=voxel"
  TradeSetting setting;
  std::string option, value;  ///< Of a single change; else empty.
};

/// The base, then each value of each option by itself.
[[nodiscard]] std::vector<NamedSetting> singleChanges(const SimulationSetting& base,
                                                      const std::vector<TradeOption>& options);
/// The base with the changes that a name of these lists; nothing where it names no such change.
[[nodiscard]] std::optional<TradeSetting> settingNamed(const SimulationSetting& base,
                                                       const std::vector<TradeOption>& options,
                                                       const std::string& name);
/// Every two of the given changes that are of different options.
[[nodiscard]] std::vector<NamedSetting> pairedChanges(const SimulationSetting& base,
                                                      const std::vector<TradeOption>& options,
                                                      const std::vector<NamedSetting>& singles);
/// Each option is left alone half of the time, else takes one of its values.
[[nodiscard]] std::vector<NamedSetting> randomChanges(const SimulationSetting& base,
                                                      const std::vector<TradeOption>& options,
                                                      std::size_t count, std::uint64_t seed);

}  // namespace palpate
