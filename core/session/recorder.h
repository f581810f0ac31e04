#pragma once
/// The session file: one SQLite database a recording (interface.md, "Files").
///
/// The loops put samples into bounded queues; the recorder's own thread writes them twice a second
/// in one transaction, so a crash or power cut loses at most the last second. A full queue drops
/// and counts, and from then on the session says that it is inexact.

#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "core/simulation/runner.h"

namespace palpate {

class Recorder : public RunSink {
 public:
  /// Writes `file` (refused if it exists and `overwrite` is not set, or cannot be written). The
  /// session carries its own felt anatomy (labels, deflated), scene, instrument and materials, so
  /// that it replays anywhere; it names no patient and no path.
  [[nodiscard]] static Result<std::unique_ptr<Recorder>> create(const std::filesystem::path& file,
                                                                const PreparedScene& scene,
                                                                const DeviceInfo& device,
                                                                const RunOptions& options,
                                                                bool overwrite);

  [[nodiscard]] virtual std::uint64_t drops() const noexcept = 0;
  /// Writes what is left and the run's report. After this the sink takes nothing more.
  [[nodiscard]] virtual Result<void> finish(const RunReport& report) = 0;
};

}  // namespace palpate
