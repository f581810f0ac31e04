#include "core/trade/options.h"

#include <random>
#include <sstream>

#include "core/base/short_number.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

using Simulation = SimulationSetting;

/// A switch: its one other value.
TradeOption flipped(const char* name, bool on, const std::function<bool&(Simulation&)>& field) {
  return {name, {{on ? "off" : "on", [on, field](TradeSetting& s) { field(s.simulation) = !on; }}}};
}

/// A number: those of `values` that are not the base's own.
template <class T>
TradeOption numbers(const char* name, T own, const std::vector<T>& values,
                    const std::function<std::string(T)>& text,
                    const std::function<void(TradeSetting&, T)>& set) {
  TradeOption option{name, {}};
  for (const T value : values) {
    if (value == own) continue;
    option.values.push_back({text(value), [set, value](TradeSetting& s) { set(s, value); }});
  }
  return option;
}

std::string whole(std::uint32_t value) {
  return std::to_string(value);
}

TradeOption branchings(const Simulation& base) {
  return numbers<std::uint32_t>("branching", static_cast<std::uint32_t>(base.tree.branching),
                                {8, 64, 512}, whole, [](TradeSetting& s, std::uint32_t n) {
                                  s.simulation.tree.branching = static_cast<Branching>(n);
                                });
}

TradeOption leaves(const Simulation& base) {
  const bool distance = base.tree.leaf == LeafModel::Distance;
  return {"leaf", {{distance ? "voxel" : "distance", [distance](TradeSetting& s) {
                      s.simulation.tree.leaf = distance ? LeafModel::Voxel : LeafModel::Distance;
                    }}}};
}

TradeOption methods(const Simulation& base) {
  TradeOption option{"method", {}};
  const std::pair<QueryMethod, const char*> all[] = {{QueryMethod::Hierarchy, "hierarchy"},
                                                     {QueryMethod::Paper, "paper"},
                                                     {QueryMethod::BruteForce, "brute-force"}};
  for (const auto& [method, name] : all) {
    if (method == base.query.method) continue;
    option.values.push_back(
        {name, [method = method](TradeSetting& s) { s.simulation.query.method = method; }});
  }
  return option;
}

TradeOption lengths(const char* name, double own, const std::vector<double>& values_m,
                    const std::function<void(TradeSetting&, double)>& set) {
  return numbers<double>(
      name, own, values_m, [](double m) { return formatted("%.2fmm", millimetres(m)); }, set);
}

}  // namespace

std::vector<TradeOption> optionsAround(const SimulationSetting& base, double spacing) {
  std::vector<TradeOption> options;
  options.push_back({"voxels",
                     {{"2x", [](TradeSetting& s) { s.coarsening = 2; }},
                      {"4x", [](TradeSetting& s) { s.coarsening = 4; }}}});
  options.push_back(branchings(base));
  options.push_back(leaves(base));
  options.push_back(flipped("surface-only", base.tree.surfaceOnly,
                            [](Simulation& s) -> bool& { return s.tree.surfaceOnly; }));
  options.push_back(methods(base));
  options.push_back(flipped("tight-spheres", base.query.tightSpheres,
                            [](Simulation& s) -> bool& { return s.query.tightSpheres; }));
  options.push_back(flipped("one-child-skip", base.query.oneChildSkip,
                            [](Simulation& s) -> bool& { return s.query.oneChildSkip; }));
  options.push_back(flipped("side-offset", base.query.sideOffset,
                            [](Simulation& s) -> bool& { return s.query.sideOffset; }));
  options.push_back(numbers<std::uint32_t>("stop-level",
                                           static_cast<std::uint32_t>(base.query.stopLevel),
                                           {0, 1, 2}, whole, [](TradeSetting& s, std::uint32_t n) {
                                             s.simulation.query.stopLevel = static_cast<int>(n);
                                           }));
  options.push_back(numbers<std::uint32_t>(
      "budget", base.query.contactBudget, {8, 32, 128}, whole,
      [](TradeSetting& s, std::uint32_t n) { s.simulation.query.contactBudget = n; }));
  options.push_back(
      lengths("perceptual", base.query.perceptualBound, {0.25e-3, 0.5e-3, 1e-3, 2e-3},
              [](TradeSetting& s, double m) { s.simulation.query.perceptualBound = m; }));
  options.push_back(lengths("shell", spacing, {0.5 * spacing, 2.0 * spacing, 4.0 * spacing},
                            [](TradeSetting& s, double m) { s.simulation.shellSpacing = m; }));
  options.push_back(flipped("coherence", base.query.coherence,
                            [](Simulation& s) -> bool& { return s.query.coherence; }));
  options.push_back(numbers<std::uint32_t>(
      "iterations", base.solverIterations, {5, 20, 50, 200, 1000}, whole,
      [](TradeSetting& s, std::uint32_t n) { s.simulation.solverIterations = n; }));
  options.push_back(numbers<std::uint32_t>(
      "threads", static_cast<std::uint32_t>(base.query.threads), {1, 2}, whole,
      [](TradeSetting& s, std::uint32_t n) { s.simulation.query.threads = static_cast<int>(n); }));
  options.push_back(numbers<double>(
      "rate", base.stepPeriod, {1e-3, 2e-3, 5e-3, 10e-3},
      [](double s) { return formatted("%.0fHz", 1.0 / s); },
      [](TradeSetting& s, double period) { s.simulation.stepPeriod = period; }));
  options.push_back({"precision", {{"double", [](TradeSetting& s) { s.doublePrecision = true; }}}});
  return options;
}

std::vector<NamedSetting> singleChanges(const SimulationSetting& base,
                                        const std::vector<TradeOption>& options) {
  std::vector<NamedSetting> all{{"default", {base}, {}, {}}};
  for (const TradeOption& option : options) {
    for (const OptionValue& value : option.values) {
      NamedSetting named{option.name + "=" + value.name, {base}, option.name, value.name};
      value.apply(named.setting);
      all.push_back(std::move(named));
    }
  }
  return all;
}

std::optional<TradeSetting> settingNamed(const SimulationSetting& base,
                                         const std::vector<TradeOption>& options,
                                         const std::string& name) {
  TradeSetting setting{base};
  if (name == "default") return setting;
  std::istringstream words(name);
  std::string word;
  bool any = false;
  while (words >> word) {
    any = false;
    for (const TradeOption& option : options) {
      for (const OptionValue& value : option.values) {
        if (word != option.name + "=" + value.name) continue;
        value.apply(setting);
        any = true;
      }
    }
    if (!any) return std::nullopt;
  }
  return any ? std::optional(setting) : std::nullopt;
}

std::vector<NamedSetting> pairedChanges(const SimulationSetting& base,
                                        const std::vector<TradeOption>& options,
                                        const std::vector<NamedSetting>& singles) {
  std::vector<NamedSetting> all;
  for (std::size_t a = 0; a < singles.size(); ++a) {
    for (std::size_t b = a + 1; b < singles.size(); ++b) {
      if (singles[a].option == singles[b].option) continue;
      const std::string name = singles[a].name + " " + singles[b].name;
      const auto setting = settingNamed(base, options, name);
      if (setting) all.push_back({name, *setting, {}, {}});
    }
  }
  return all;
}

std::vector<NamedSetting> randomChanges(const SimulationSetting& base,
                                        const std::vector<TradeOption>& options, std::size_t count,
                                        std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<NamedSetting> all;
  while (all.size() < count) {
    NamedSetting named{"", {base}, {}, {}};
    for (const TradeOption& option : options) {
      if ((random() >> 63U) != 0 || option.name == "precision") continue;
      const OptionValue& value = option.values[random() % option.values.size()];
      value.apply(named.setting);
      named.name += (named.name.empty() ? "" : " ") + option.name + "=" + value.name;
    }
    if (!named.name.empty()) all.push_back(std::move(named));
  }
  return all;
}

}  // namespace palpate
