#pragma once
/// Replays a session without a device: the same samples, steps and commands give the same states.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"
#include "core/simulation/runner.h"

namespace palpate {

/// What a session says of itself before any of it is played.
struct SessionHeader {
  Scene scene;
  std::string deviceName, programVersion;
  std::uint64_t sceneFingerprint = 0, seed = 0, steps = 0, ticks = 0;
  bool exact = true;     ///< False after a recorder drop.
  bool finished = true;  ///< False after a crash: the tail may be missing.
  RunReport report;
};

/// The scene as it was recorded, rebuilt from the session file alone.
[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> prepareSession(
    const std::filesystem::path& file, const Progress& progress = {});

/// Refuses a file that is not a session, is damaged, or is of a later format, saying which.
[[nodiscard]] Result<SessionHeader> readSessionHeader(const std::filesystem::path& file);

struct StepDifference {
  std::uint64_t step = 0;
  std::uint64_t expectedHash = 0, foundHash = 0;
};

/// A change of level as it was recorded.
struct RecordedLevel {
  std::uint64_t step = 0;  ///< The first at that level.
  std::size_t level = 0;   ///< Of the recorded scene's levels.
};

struct ReplayReport {
  bool identical = false;
  std::uint64_t steps = 0;
  std::optional<StepDifference> firstDifference;
  double forceErrorMax = 0;           ///< N, against the recording; when at another setting.
  double depthErrorMax = 0;           ///< m
  std::vector<RecordedLevel> levels;  ///< In their order.
};

/// Plays every step at full speed and compares the hash of each. `onSnapshot` (may be empty) is
/// called after each step, for the window.
[[nodiscard]] Result<ReplayReport> replaySession(
    const std::filesystem::path& file, std::shared_ptr<const PreparedScene> scene,
    const Progress& progress = {}, const std::function<void(const Snapshot&)>& onSnapshot = {});

/// Every recorded servo sample, world axes: what the hand did, for a simulated hand to do it again.
[[nodiscard]] Result<std::vector<ServoSample>> readSamples(const std::filesystem::path& file);

/// The recorded steps for scrubbing in the window: one row every `stride` steps.
[[nodiscard]] Result<std::vector<StepRecord>> readSteps(const std::filesystem::path& file,
                                                        std::uint64_t stride);

}  // namespace palpate
