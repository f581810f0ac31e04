#pragma once
/// One simulation step: the newest device sample in, the tool's state out.
///
/// coupling -> contacts -> response -> poses. The step lasts as long as the devices' samples lie
/// apart, so that the tool keeps the pace of the hand where the machine does not keep its own; the
/// coupling is softened for long steps (recommendedGains). Where the tool, the hand or a body is so
/// fast that a point could move farther than half a voxel, the step is done in up to eight parts:
/// so a shell of a single voxel is not passed through. Called by the runner's thread, by the
/// virtual clock, or by a replay; equal samples and commands give equal bits. World axes, SI.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/dynamics/loose_body.h"
#include "core/dynamics/tool_body.h"
#include "core/haptics/messages.h"
#include "core/haptics/virtual_coupling.h"
#include "core/simulation/contact_gathering.h"
#include "core/simulation/prepared_scene.h"
#include "core/simulation/runner.h"
#include "core/simulation/snapshot.h"

namespace palpate {

class Simulation {
 public:
  /// Takes all memory that steps need.
  Simulation(std::shared_ptr<const PreparedScene> scene, const CouplingGains& gains);

  /// Between steps, in order. Real-time safe.
  void apply(const Command& command) noexcept;
  /// Real-time safe: no allocation, lock, exception or log. The first step, and the first after
  /// ResetTool, puts the tool at rest where the device is.
  const StepRecord& step(const DeviceSample& sample_W) noexcept;

  [[nodiscard]] const StepRecord& record() const noexcept { return record_; }
  /// For the servo: of the last step.
  [[nodiscard]] const ToolState& tool() const noexcept { return tool_; }
  /// The tool's contacts of the last step, p and n in W, by touched body and ascending shellIndex.
  [[nodiscard]] std::span<const Contact> contacts_W() const noexcept { return gathering_.ofTool(); }
  /// Contacts were left out or cut: capacity or budget reached in the last step.
  [[nodiscard]] bool contactsCut() const noexcept { return gathering_.cut(); }
  /// The scene's loose bodies, in its order.
  [[nodiscard]] std::span<const LooseBody> bodies() const noexcept { return bodies_; }
  /// What the last step's response took.
  [[nodiscard]] const ResponseEffort& effort() const noexcept { return effort_; }
  /// The coupling in force.
  [[nodiscard]] CouplingGains coupling() const noexcept { return softened(gains_, share_); }
  /// Fills what the simulation knows: step, time, poses, contacts (the deepest, where they are
  /// many). Real-time safe.
  void fill(Snapshot& snapshot) noexcept;
  /// Of the scene's levels; 0 where it has none.
  [[nodiscard]] std::size_t level() const noexcept { return level_; }
  [[nodiscard]] std::uint32_t stepTicks() const noexcept { return stepTicks_; }
  /// The buffers a step touches most, to be locked in memory.
  [[nodiscard]] std::span<const Contact> contactMemory() const noexcept {
    return gathering_.memory();
  }

 private:
  void keepPace(const DeviceSample& sample_W) noexcept;
  [[nodiscard]] std::uint32_t partsFor(const DeviceSample& sample_W) const noexcept;
  void stepPart(const ToolTarget& target, double dt) noexcept;
  void softenCoupling() noexcept;
  void setLevel(double value) noexcept;
  void limitIterations() noexcept;
  void findContacts() noexcept;
  void resolveContacts(double dt) noexcept;
  void publish(const DeviceSample& sample_W) noexcept;
  void chainHash() noexcept;
  void fillLevel(Snapshot& snapshot) noexcept;
  void fillContacts(Snapshot& snapshot) noexcept;

  std::shared_ptr<const PreparedScene> scene_;
  CouplingGains gains_;
  double halfVoxel_;     ///< m, of the finest tree: what a point may move in a part of a step.
  double declared_, h_;  ///< s: a step as the scene has it, and the present one.
  std::uint32_t stepTicks_;
  double pace_;               ///< Servo ticks a step takes lately; rises at once, falls slowly.
  double userShare_, share_;  ///< Of the coupling's stiffness: wanted, and in force.
  std::size_t level_ = 0;
  std::uint64_t levelChanges_ = 0;
  double levelSince_ = 0.0;  ///< s, simulated
  std::uint32_t userIterations_;
  ResponseSettings response_;
  ToolBody body_;
  std::vector<LooseBody> bodies_;
  std::vector<Eigen::Isometry3d> X_WB_;
  ContactGathering gathering_;
  ContactResolver resolver_;
  std::vector<ContactBody> moving_;  ///< The tool, then the bodies.
  std::vector<BodyResponse> answered_;
  ResponseEffort effort_;
  std::vector<std::uint32_t> byDepth_;
  bool resetWanted_ = true;
  DeviceSample sample_;
  StepRecord record_;
  ToolState tool_;
};

}  // namespace palpate
