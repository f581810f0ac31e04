#pragma once
/// The trade between speed and accuracy: every setting measured over the same motions.
///
/// Errors are against a reference that shares no code with what is judged (reference_shape.h,
/// reference_loop.h): the closed form where the anatomy is a known shape, else the labels' own
/// resolution in double precision, with a shell of half the spacing. Same scene, seed and build:
/// the same errors and counts to the last bit, whatever the number of threads. Times are this
/// machine's, now. Loose bodies are left out. Any thread, nothing here is real-time safe.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/haptics/device.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/errors.h"
#include "core/trade/growth.h"
#include "core/trade/options.h"
#include "core/trade/reference_shape.h"

namespace palpate {

/// How much is tried: `Quick` takes seconds (a dozen settings that differ, 81 motions), `Whole`
/// minutes (single changes, pairs of the five options that matter most, 50 random combinations; 181
/// motions, 100 of them random approaches), `Full` four times as many of both.
enum class TradeEffort : std::uint8_t { Quick, Whole, Full };

struct TradeRequest {
  std::uint64_t seed = 1;
  TradeEffort effort = TradeEffort::Whole;
  DeviceInfo device;                ///< Its coupling.
  std::optional<KnownShape> shape;  ///< The scene's labels are voxelsOf() this.
  /// `Quick` tries the best setting that fits this step time once more, with each change that a
  /// running simulation can make (governor_ladder.h): what a governor steps down to. 0: none.
  double limit_us = 0.0;
  std::vector<Trajectory> recorded;  ///< Motions of sessions, besides the made ones.
};

struct TradeCost {
  double p50_us = 0, p99_us = 0, p999_us = 0, worst_us = 0;  ///< Of a step.
  double testsP50 = 0, testsP99 = 0;                         ///< Sphere and leaf tests a step.
  std::size_t shellPoints = 0, bytes = 0;
  double build_ms = 0;  ///< Of the tree.
};

/// What is promised of other motions of the same kind (promise.h).
struct TradePromise {
  double force_N = 0, depth_mm = 0;  ///< p95 of the errors.
  double p999_us = 0;                ///< Of a step, from the longest of its repeats.
};

struct TradePoint {
  std::string name;           ///< "reference", "default", "branching=8", "shell=1.00mm leaf=voxel"
  std::string option, value;  ///< Of a single change; else empty.
  TradeSetting setting;
  TradeErrors errors;
  TradeCost cost;
  TradePromise promise;
  std::size_t leftOut = 0;  ///< Motions on which the reference's own loop, as a setting, is lost.
  bool onFront = false;
  bool offered = true;  ///< A scene can declare it. The reference, for one, it cannot.
};

struct TradeSweep {
  std::uint64_t seed = 1;
  std::string reference;                  ///< What the reference is, in words.
  std::vector<std::string> trajectories;  ///< Names.
  std::vector<std::string> leftOut;       ///< Of motions on which the reference did not settle.
  std::vector<TradePoint> points;         ///< The reference first, then the default.
  std::vector<Growth> growth;
};

[[nodiscard]] Result<TradeSweep> sweepTrade(const PreparedScene& base, const TradeRequest& request,
                                            const Progress& progress = {});

/// One setting over other motions of the same kind: what a promise is checked with.
[[nodiscard]] Result<TradePoint> measureSetting(const PreparedScene& base,
                                                const TradeRequest& request,
                                                const NamedSetting& setting,
                                                const Progress& progress = {});

}  // namespace palpate
