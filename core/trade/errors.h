#pragma once
/// How far a setting is from the reference.

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/simulation/prepared_scene.h"
#include "core/trade/felt.h"
#include "core/trade/probes.h"
#include "core/trade/trajectory.h"

namespace palpate {

/// By nearest rank; zeros of nothing.
struct Spread {
  double median = 0.0, p95 = 0.0, worst = 0.0;
};
[[nodiscard]] Spread spreadOf(std::vector<double> values);
/// The value that a share of them does not exceed, by nearest rank; 0 of nothing.
[[nodiscard]] double percentile(std::vector<double> values, double share);

struct TradeErrors {
  Spread force_N, torque_Nmm;  ///< On the hand, in ticks where either is in contact.
  Spread depth_mm;             ///< Of the deepest contact at a probed pose.
  Spread normal_deg;           ///< Of the contacts' mean normal, weighted by depth.
  /// Of the setting's own shell points at the probed poses: those that the reference finds inside
  /// and the setting does not, and the reverse; how many the reference finds.
  std::uint64_t missed = 0, extra = 0, reference = 0;
  /// Along smooth motion: force less its mean over 21 ms; and its change from tick to tick.
  Spread ripple_N, jump_N_per_ms;
  Spread rest_mm;   ///< Of the tool's place where the hand is still, a value a trajectory.
  Spread onset_ms;  ///< Of the first 0.05 N, a value a trajectory; below 0 counts like above.
};

/// Gathers samples of one setting over many trajectories.
class ErrorSamples {
 public:
  void addFelt(const Trajectory& trajectory, const Felt& felt, const Felt& reference);
  /// The setting's own query at the poses. @param judged  of the scene's shell, as many.
  void addContacts(const PreparedScene& scene, std::span<const ProbedPose> poses,
                   std::span<const JudgedPose> judged);
  /// The reference itself with the points of a scene's shell, as if it were a setting.
  /// @param found  at the same poses, with that shell.
  void addReferenceContacts(std::span<const ProbedPose> poses, std::span<const ProbedPose> found);
  [[nodiscard]] TradeErrors errors() const;
  /// What can be promised of p95 over other motions of the kind: force N, depth mm.
  [[nodiscard]] double promisedForce() const;
  [[nodiscard]] double promisedDepth() const;

 private:
  /// @param found  by shell index; not the same afterwards.
  void addPoints(std::vector<bool>& found, const JudgedPose& judged);
  void addPose(const ProbedPose& pose, double deepest, const Eigen::Vector3d& normal_W);

  using ByMotion = std::vector<std::vector<double>>;
  ByMotion force_, depth_;
  std::vector<double> torque_, normal_, ripple_, jump_, rest_, onset_;
  std::uint64_t missed_ = 0, extra_ = 0, reference_ = 0;
};

}  // namespace palpate
