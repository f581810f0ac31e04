#pragma once
/// One prepared scene under the window's hand: starts and stops the runner, arms, records.
///
/// Main thread only; the runner owns its threads.

#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/devices/hand.h"
#include "core/session/recorder.h"
#include "core/simulation/prepared_scene.h"
#include "core/simulation/runner.h"
#include "ui/model.h"

namespace palpate {

class DesktopSimulation {
 public:
  ~DesktopSimulation();

  /// Stops what runs and takes a new scene; null: none.
  void setScene(std::shared_ptr<const PreparedScene> scene);
  /// As setScene(); what runs goes on in the new scene, the hand where it was, the force let go.
  [[nodiscard]] Result<void> replaceScene(std::shared_ptr<const PreparedScene> scene);
  [[nodiscard]] const PreparedScene* scene() const noexcept { return scene_.get(); }
  [[nodiscard]] std::shared_ptr<const PreparedScene> shared() const noexcept { return scene_; }

  /// A simulated model, or a Phantom by its listed name with what it says of itself.
  void setDevice(const std::string& name, const std::optional<DeviceInfo>& hardware);
  void setHand(ui::HandKind hand) noexcept { handKind_ = hand; }
  [[nodiscard]] const DeviceInfo& info();  ///< Of the chosen device.

  /// A new run from rest. `recordTo` empty: not recorded. Virtual: the caller advances it.
  [[nodiscard]] Result<void> start(Clock clock, const std::filesystem::path& recordTo);
  void advanceVirtual(double seconds);
  /// Ends the run and finishes the recording, if there is one.
  [[nodiscard]] Result<void> stop();
  [[nodiscard]] bool running() const noexcept { return runner_ != nullptr; }
  [[nodiscard]] bool recording() const noexcept { return recorder_ != nullptr; }

  /// Of the run so far; nothing while none runs.
  [[nodiscard]] std::optional<RunReport> report() const;

  void arm(bool on);
  void forceOff();
  void clearFault();
  void confirmCalibration();
  /// On a thread of its own; retried by itself while the device is gone.
  void reconnect();
  /// False: the queue of commands was full; nothing was taken.
  [[nodiscard]] bool send(const Command& command);
  void moveHand(const Eigen::Vector3d& delta_W);
  void turnHand(const Eigen::Vector3d& rotation_W);

  /// Takes the newest snapshot; null without a scene. When nothing runs: the instrument at rest,
  /// or where it was when the run ended.
  const Snapshot* refresh();
  void describe(ui::Model& model) const;

 private:
  void restSnapshot();
  void lookAtDevice();
  [[nodiscard]] bool reconnecting() const;
  [[nodiscard]] Result<std::unique_ptr<HapticDevice>> makeDevice();
  std::shared_ptr<const PreparedScene> scene_;
  std::string device_ = "touch-x";
  std::optional<DeviceInfo> hardware_;
  std::string infoOf_;
  DeviceInfo info_;
  ui::HandKind handKind_ = ui::HandKind::Mouse;
  std::shared_ptr<FollowingHand> mouseHand_;
  HandTarget target_;
  std::unique_ptr<Recorder> recorder_;  // outlives the runner
  std::unique_ptr<Runner> runner_;
  Snapshot last_;
  DeviceCondition condition_;
  std::chrono::steady_clock::time_point lookedAt_, triedAt_;
  std::future<Result<void>> reconnect_;  // waited for before the runner goes
  bool armed_ = false;
  Clock clock_ = Clock::Real;
};

/// Rows of the instrument list: size, mass, and a half-profile for the little picture.
[[nodiscard]] ui::InstrumentRow describeInstrument(const Instrument& instrument);

}  // namespace palpate
