#include "app/frame_report.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/whole_file.h"

namespace palpate {
namespace {

constexpr double kSlow_s = 0.05;

double monotonic() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// "VmHWM" or "VmRSS" of this process; 0 where the system does not say.
double memoryMiB(const std::string& which) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(which + ':', 0) == 0) return std::stod(line.substr(which.size() + 1)) / 1024.0;
  }
  return 0.0;
}

/// proc(5): 5 sets the high-water mark to what is in use now.
void forgetPeak() {
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

}  // namespace

void FrameReport::end() {
  if (phases_.empty()) return;
  Phase& phase = phases_.back();
  phase.seconds = monotonic() - phase.began;
  phase.peakMiB = memoryMiB("VmHWM");
  phase.endMiB = memoryMiB("VmRSS");
}

void FrameReport::begin(const std::string& phase) {
  end();
  forgetPeak();
  Phase& next = phases_.emplace_back();
  next.name = phase;
  next.began = monotonic();
}

void FrameReport::add(const Frame& frame) {
  if (phases_.empty()) begin("start");
  Phase& phase = phases_.back();
  const double took = frame.ours + frame.drawing;
  ++phase.frames;
  if (took > kSlow_s) ++phase.slow;
  phase.longest = std::max(phase.longest, took);
  phase.ours = std::max(phase.ours, frame.ours);
  phase.drawing = std::max(phase.drawing, frame.drawing);
  if (frame.busy) phase.busy = monotonic() - phase.began;
}

Result<void> FrameReport::write(const std::filesystem::path& file) {
  end();
  nlohmann::ordered_json json;
  json["phases"] = nlohmann::ordered_json::array();
  for (const Phase& phase : phases_) {
    json["phases"].push_back({{"name", phase.name},
                              {"seconds", phase.seconds},
                              {"busy_s", phase.busy},
                              {"frames", phase.frames},
                              {"frame_ms", 1e3 * phase.longest},
                              {"ours_ms", 1e3 * phase.ours},
                              {"drawing_ms", 1e3 * phase.drawing},
                              {"frames_over_50_ms", phase.slow},
                              {"peak_MiB", phase.peakMiB},
                              {"end_MiB", phase.endMiB}});
  }
  return writeWholeFile(file, json.dump(1) + "\n");
}

}  // namespace palpate
