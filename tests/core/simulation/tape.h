#pragma once
/// A sink for tests that keeps everything.

#include <utility>
#include <vector>

#include "core/simulation/runner.h"

namespace palpate {

/// Keeps what the run told, in memory taken beforehand.
class Tape final : public RunSink {
 public:
  explicit Tape(std::size_t capacity) {
    ticks.reserve(capacity);
    steps.reserve(capacity);
  }
  bool onTick(const ServoSample& sample) noexcept override {
    if (ticks.size() == ticks.capacity()) return false;
    ticks.push_back(sample);
    return true;
  }
  bool onStep(const StepRecord& step) noexcept override {
    if (steps.size() == steps.capacity()) return false;
    steps.push_back(step);
    return true;
  }
  bool onCommand(std::uint64_t step, const Command& command) noexcept override {
    commands.emplace_back(step, command);
    return true;
  }
  std::vector<ServoSample> ticks;
  std::vector<StepRecord> steps;
  std::vector<std::pair<std::uint64_t, Command>> commands;
};

}  // namespace palpate
