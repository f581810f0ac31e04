/// Simulation and review: what their buttons do.

#include <algorithm>
#include <cstdio>

#include "app/desktop_loop.h"
#include "core/base/progress_part.h"
#include "core/devices/simulated_phantom.h"

namespace palpate {

void Desktop::stopRun() {
  const bool recorded = simulation_.recording();
  if (auto stopped = simulation_.stop(); !stopped) {
    complain(stopped.error(), "The recording is kept as far as it was written.");
  } else if (recorded) {
    refreshSessions();
    say({ui::MessageModel::Kind::Information, "The session is saved.",
         "It holds the motion, every step and the anatomy; no name and no path.",
         "Replay it in Review."});
  }
  model_.simulate.grabbed = false;
}

void Desktop::lookForDevices() {
  model_.simulate.devices = simulatedModels();
  hardware_.assign(model_.simulate.devices.size(), std::nullopt);
  const auto touchX =
      std::find(model_.simulate.devices.begin(), model_.simulate.devices.end(), "touch-x");
  model_.simulate.device = static_cast<std::size_t>(touchX - model_.simulate.devices.begin());
  // The vendor's library may take seconds to say that nothing is there. Not for pictures.
  if (options_.screenshot) return;
  devices_ = std::async(std::launch::async, [] { return listDevices(); });
}

void Desktop::chooseDevice(std::size_t index) {
  if (index >= model_.simulate.devices.size() || simulation_.running()) return;
  model_.simulate.device = index;
  model_.simulate.hardware = hardware_[index].has_value();
  if (model_.simulate.hardware)
    model_.simulate.latch = false;  // Real force is held, never latched.
  simulation_.setDevice(model_.simulate.devices[index], hardware_[index]);
}

void Desktop::startStop() {
  if (simulation_.running()) {
    stopRun();
    return;
  }
  if (simulation_.scene() == nullptr) {
    say({ui::MessageModel::Kind::Information, "The simulation cannot start yet.",
         model_.simulate.notReady, ""});
    return;
  }
  jobs_.dropIdle();  // what it measures would be times of a busy machine
  const Clock clock = options_.screenshot ? Clock::Virtual : Clock::Real;
  if (auto started = simulation_.start(clock, {}); !started) return complain(started.error());
  model_.task = model_.task == ui::Task::Review ? ui::Task::Simulate : model_.task;
}

void Desktop::record() {
  if (simulation_.recording()) {
    stopRun();
    return;
  }
  if (simulation_.scene() == nullptr || !open_) return;
  stopRun();
  // From rest: a session replays bit for bit only from its first step.
  if (auto started = simulation_.start(Clock::Real, newSessionFile(open_->folder)); !started) {
    complain(started.error(), "Nothing is recorded.");
  }
}

void Desktop::refreshSessions() {
  model_.review.sessions.clear();
  model_.review.chosen.reset();
  if (open_) model_.review.sessions = listSessions(open_->folder / "sessions");
}

void Desktop::chooseSession(std::size_t index) {
  if (index >= model_.review.sessions.size() || jobs_.busy()) return;
  stopRun();
  const auto file = model_.review.sessions[index].file;
  jobs_.add("Reading the session", [this, index, file](const Progress& progress) {
    progress(0.1, "Reading its steps");
    auto session = std::make_shared<Result<LoadedSession>>(loadSession(file));
    return [this, index, session] {
      if (!*session) return complain(session->error(), "The other sessions are unaffected.");
      model_.review.chosen = index;
      review_.setSession(std::move(**session));
    };
  });
}

void Desktop::replay() {
  if (!review_.loaded() || jobs_.busy()) return;
  review_.setReplaying(true);
  jobs_.add("Replaying the session",
            [this, file = review_.session().file](const Progress& progress) {
              Result<ReplayReport> report = fail(cancelled());
              auto scene = prepareSession(file, shareOf(progress, 0.0, 0.3));
              if (!scene) {
                report = fail(scene.error());
              } else {
                report = replaySession(file, *scene, shareOf(progress, 0.3, 1.0),
                                       [this](const Snapshot& snapshot) {
                                         // A snapshot is large and the screen slow: one in sixteen
                                         // is seen.
                                         if (snapshot.step % 16 == 0)
                                           review_.live().publish(snapshot);
                                       });
              }
              return [this, report] {
                review_.setReplaying(false);
                review_.scrub(0.0);
                if (!report && report.error().kind != ErrorKind::Cancelled)
                  complain(report.error());
                review_.setVerdict(report);
              };
            });
}

}  // namespace palpate
