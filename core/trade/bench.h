#pragma once
/// The motions of a sweep with what the reference feels along them; measures settings over them.
///
/// The reference works on as many motions at once as there are processors; what is measured runs
/// alone.

#include <functional>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/trade/tradeoff.h"
#include "core/trade/variants.h"

namespace palpate {

/// The base outlives it. One thread at a time; progress is reported from any, one at a time.
class Bench {
 public:
  /// Makes the motions and runs the reference over them.
  [[nodiscard]] static Result<Bench> create(const PreparedScene& base, const TradeRequest& request,
                                            const Progress& progress);

  /// The reference as a point: no error, and what it costs, others of its motions running beside.
  [[nodiscard]] const TradePoint& reference() const noexcept { return reference_; }
  [[nodiscard]] std::vector<std::string> names() const;
  /// Motions that are left out, since the reference did not settle (reference_loop.h).
  [[nodiscard]] const std::vector<std::string>& leftOut() const noexcept { return leftOut_; }
  [[nodiscard]] Result<TradePoint> measure(const NamedSetting& setting, const Progress& progress);
  /// Time and tests of single queries of the base, and the contacts of each, at poses pressed
  /// deeper and deeper; for the growth over contacts.
  struct Queries {
    std::vector<double> contacts, micros, tests;
  };
  [[nodiscard]] Queries queries();
  [[nodiscard]] Variants& variants() noexcept { return variants_; }

 private:
  struct Motion {
    Trajectory trajectory;
    Pass reference;
    std::vector<ProbedPose> probed;  ///< Where contacts are compared.
  };
  /// Makes a motion; an empty one where there is none.
  using Maker = std::function<Trajectory()>;
  /// Where the reference has a shell's points, by motion; settings share shells.
  struct Judged {
    const PointShell* shell = nullptr;
    double undecided = 0.0;  ///< m
    std::vector<std::vector<JudgedPose>> byMotion;
  };
  Bench(const PreparedScene& base, const TradeRequest& request);
  [[nodiscard]] Result<void> addMotions(const Progress& progress);
  [[nodiscard]] std::vector<Maker> makers() const;
  [[nodiscard]] Motion motionOf(const Maker& make) const;
  [[nodiscard]] const Judged* judgedFor(const PreparedScene& scene, const Progress& progress);
  [[nodiscard]] CouplingGains gainsOf(const SimulationSetting& setting) const;
  void addCost(const Pass& pass);
  [[nodiscard]] TradeCost costOf(const PreparedScene& scene, bool reference) const;

  const PreparedScene& base_;
  TradeRequest request_;
  Variants variants_;
  std::unique_ptr<ReferenceShape> shape_;
  std::shared_ptr<const PointShell> finest_;
  std::vector<Motion> motions_;
  std::vector<std::string> leftOut_;
  std::vector<std::unique_ptr<const Judged>> judged_;
  TradePoint reference_;
  std::vector<std::vector<double>> micros_;  ///< Of the setting that is measured, by motion.
  std::vector<std::vector<double>> slowest_;
  std::vector<double> tests_;
};

}  // namespace palpate
