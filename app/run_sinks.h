#pragma once
/// Sinks of a run besides the recorder: the rows of --samples, --steps and --bodies, and one sink
/// for several.

#include <cstddef>
#include <span>
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

/// Keeps every simulation step for `simulate --steps`. As SampleSink.
class StepSink : public RunSink {
 public:
  explicit StepSink(std::size_t capacity) { rows_.reserve(capacity); }

  bool onTick(const ServoSample&) noexcept override { return true; }
  bool onStep(const StepRecord& step) noexcept override;
  bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }

  /// step,step_ms,parts,contacts,body_contacts,depth_mm,tests,impulses,time_us,stiffness_N_per_m
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }

 private:
  std::vector<StepRecord> rows_;
  std::size_t dropped_ = 0;
};

/// Keeps the loose bodies' places for `simulate --bodies`. As SampleSink.
class BodySink : public RunSink {
 public:
  explicit BodySink(std::size_t capacity) { rows_.reserve(capacity); }

  bool onTick(const ServoSample&) noexcept override { return true; }
  bool onStep(const StepRecord&) noexcept override { return true; }
  bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }
  bool onBodies(std::uint64_t step, std::span<const LooseBody> bodies) noexcept override;

  /// step,body,x_mm,y_mm,z_mm,qw,qx,qy,qz: centre of mass and turn from the start, world axes.
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] std::size_t dropped() const noexcept { return dropped_; }

 private:
  struct Row {
    std::uint64_t step = 0, body = 0;
    double centre[3] = {0, 0, 0};
    PlainPose pose;
  };
  std::vector<Row> rows_;
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
  bool onBodies(std::uint64_t step, std::span<const LooseBody> bodies) noexcept override;

 private:
  std::vector<RunSink*> sinks_;
};

}  // namespace palpate
