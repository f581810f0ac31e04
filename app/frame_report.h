#pragma once
/// What the frames of a scripted window cost, in phases that the script names. Main thread.

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace palpate {

class FrameReport {
 public:
  /// Of one frame, seconds, without the time it slept.
  struct Frame {
    double ours = 0.0;     ///< What was done was taken, what was asked for carried out.
    double drawing = 0.0;  ///< Views, panels, textures, the exchange of buffers.
    bool busy = false;     ///< Work ran beside the window.
  };

  /// Ends the phase before; its peak of memory starts from what is in use now.
  void begin(const std::string& phase);
  void add(const Frame& frame);
  /// JSON, `phases`: of each its name, `seconds`, `busy_s` (from its begin until work beside the
  /// window last ran), `frames`, the longest frame (`frame_ms`) and its parts (`ours_ms`,
  /// `drawing_ms`; each the longest of its own), `frames_over_50_ms` and the program's memory at
  /// its peak and at the end.
  [[nodiscard]] Result<void> write(const std::filesystem::path& file);

 private:
  struct Phase {
    std::string name;
    double began = 0.0, seconds = 0.0, busy = 0.0;
    std::size_t frames = 0, slow = 0;
    double longest = 0.0, ours = 0.0, drawing = 0.0;
    double peakMiB = 0.0, endMiB = 0.0;
  };
  void end();
  std::vector<Phase> phases_;
};

}  // namespace palpate
