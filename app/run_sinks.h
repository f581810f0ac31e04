#pragma once
/// Sinks of a run besides the recorder: the rows of --samples, and one sink for two.

#include <cstddef>
#include <string>
#include <vector>

#include "core/simulation/runner.h"

namespace palpate {

/// Keeps every servo tick for `simulate --samples`. Room is taken at construction; onTick is
/// real-time safe and counts what finds no room. Read it when the run has ended.
class SampleSink : public RunSink {
 public:
  explicit SampleSink(std::size_t capacity) { rows_.reserve(capacity); }

  bool onTick(const ServoSample& sample) noexcept override;
  bool onStep(const StepRecord&) noexcept override { return true; }
  bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }

  /// The columns of interface.md, one row a tick.
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }

 private:
  std::vector<ServoSample> rows_;
  std::size_t dropped_ = 0;
};

/// Hands everything to each of its sinks; false if one of them dropped. The sinks outlive it; add
/// before the run starts.
class TeeSink : public RunSink {
 public:
  void add(RunSink& sink) { sinks_.push_back(&sink); }
  [[nodiscard]] RunSink* orNull() { return sinks_.empty() ? nullptr : this; }

  bool onTick(const ServoSample& sample) noexcept override;
  bool onStep(const StepRecord& step) noexcept override;
  bool onCommand(std::uint64_t step, const Command& command) noexcept override;

 private:
  std::vector<RunSink*> sinks_;
};

}  // namespace palpate
