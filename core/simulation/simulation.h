#pragma once
/// One simulation step: the newest device sample in, the tool's state out.
///
/// coupling -> contacts -> response -> pose. Called by the runner's thread, by the virtual clock,
/// or by a replay; equal samples and commands give equal bits. World axes, SI.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/collision/contact_finder.h"
#include "core/dynamics/tool_body.h"
#include "core/haptics/messages.h"
#include "core/haptics/virtual_coupling.h"
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
  /// All contacts of the last step, p and n in W, by ascending shellIndex.
  [[nodiscard]] std::span<const Contact> contacts_W() const noexcept {
    return {contacts_.data(), contactCount_};
  }
  /// Contacts were left out or cut: capacity or budget reached in the last step.
  [[nodiscard]] bool contactsCut() const noexcept { return contactsCut_; }
  /// Fills what the simulation knows: step, time, poses, contacts (the deepest, where they are
  /// many). Real-time safe.
  void fill(Snapshot& snapshot) noexcept;
  [[nodiscard]] std::uint32_t stepTicks() const noexcept { return stepTicks_; }
  /// The buffers a step touches most, to be locked in memory.
  [[nodiscard]] std::span<const Contact> contactMemory() const noexcept { return contacts_; }

 private:
  void findContacts() noexcept;
  void publish(const DeviceSample& sample_W) noexcept;
  void chainHash() noexcept;

  std::shared_ptr<const PreparedScene> scene_;
  CouplingGains gains_;
  Eigen::Isometry3d X_WV_, X_VW_;
  double h_;
  std::uint32_t stepTicks_;
  SurfaceTable surfaces_;
  ResponseSettings response_;
  ToolBody body_;
  ContactFinder finder_;
  ContactResolver resolver_;
  std::vector<Contact> contacts_;
  std::vector<std::uint32_t> byDepth_;
  std::size_t contactCount_ = 0;
  bool contactsCut_ = false;
  bool resetWanted_ = true;
  DeviceSample sample_;
  StepRecord record_;
  ToolState tool_;
};

}  // namespace palpate
