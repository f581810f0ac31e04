#pragma once
/// Recorded sessions of a case: list, scrub, play, replay.

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/latest_value.h"
#include "core/session/replay.h"
#include "ui/model.h"

namespace palpate {

/// A session read for scrubbing.
struct LoadedSession {
  std::filesystem::path file;
  SessionHeader header;
  std::vector<StepRecord> steps;
  double stepPeriod = 1e-3;  ///< s between rows of `steps`.
};

[[nodiscard]] std::vector<ui::SessionRow> listSessions(const std::filesystem::path& folder);
/// A name for a new session in the case: `sessions/2026-11-22_07-40-12.session`.
[[nodiscard]] std::filesystem::path newSessionFile(const std::filesystem::path& caseFolder);
[[nodiscard]] Result<LoadedSession> loadSession(const std::filesystem::path& file);

/// Main thread, but for `live`, which a replay's thread writes.
class DesktopReview {
 public:
  void setSession(LoadedSession session);
  void clear();
  [[nodiscard]] bool loaded() const noexcept { return session_.has_value(); }
  [[nodiscard]] const LoadedSession& session() const { return *session_; }

  void scrub(double at_s);
  void playPause() { playing_ = !playing_; }
  void advance(double dt);  ///< Of the window's clock; plays at the recorded speed.
  void setReplaying(bool on) { replaying_ = on; }
  void setVerdict(const Result<ReplayReport>& report);
  /// Written by the replay's thread.
  LatestValue<Snapshot>& live() { return live_; }

  /// The state at the scrubbed time, or the newest of a running replay.
  const Snapshot* refresh();
  void describe(ui::ReviewModel& model) const;

 private:
  std::optional<LoadedSession> session_;
  LatestValue<Snapshot> live_;
  Snapshot shown_;
  double at_s_ = 0.0;
  bool playing_ = false, replaying_ = false;
  ui::ReviewModel::Verdict verdict_ = ui::ReviewModel::Verdict::None;
  std::string verdictText_;
  std::vector<float> time_s_, force_N_, depth_mm_;
};

}  // namespace palpate
