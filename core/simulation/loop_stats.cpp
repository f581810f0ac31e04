#include "core/simulation/loop_stats.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// interface.md: ticks_late are those due more than 100 µs ago.
constexpr std::int64_t kLate_ns = 100000;

double length(const double (&v)[3]) noexcept {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

void ServoStats::tick(const ServoSample& sample, std::int64_t nanoseconds) noexcept {
  ++figures_.ticks;
  tick_.add(nanoseconds);
  second_.add(nanoseconds);
  figures_.forceMax = std::max(figures_.forceMax, length(sample.wrench.force));
  figures_.torqueMax = std::max(figures_.torqueMax, length(sample.wrench.torque));
  figures_.handEnergy = sample.handEnergy;
  figures_.handEnergyMin = std::min(figures_.handEnergyMin, sample.handEnergy);
}

void ServoStats::woke(std::int64_t nanoseconds) noexcept {
  lateness_.add(nanoseconds);
  if (nanoseconds > kLate_ns) ++figures_.late;
}

bool ServoStats::windowEnded(std::uint64_t window) noexcept {
  if (second_.count() < window) return false;
  figures_.lastSecond = second_.timing();
  second_.clear();
  return true;
}

ServoFigures ServoStats::figures() const noexcept {
  ServoFigures all = figures_;
  all.tickTime = tick_.timing();
  all.lateness = lateness_.timing();
  all.tickBins = tick_.bins();
  all.latenessBins = lateness_.bins();
  return all;
}

void StepStats::step(const StepRecord& record) noexcept {
  ++figures_.steps;
  const auto nanoseconds = static_cast<std::int64_t>(record.micros * 1e3);
  step_.add(nanoseconds);
  second_.add(nanoseconds);
  figures_.stateHash = record.stateHash;
  figures_.contactsMax = std::max(figures_.contactsMax, record.contacts);
  figures_.penetrationMax = std::max(figures_.penetrationMax, record.depth);
}

bool StepStats::windowEnded(std::uint64_t window) noexcept {
  if (second_.count() < window) return false;
  figures_.lastSecond = second_.timing();
  second_.clear();
  return true;
}

StepFigures StepStats::figures() const noexcept {
  StepFigures all = figures_;
  all.stepTime = step_.timing();
  all.stepBins = step_.bins();
  return all;
}

RunReport reportOf(const RunOptions& options, const ServoFigures& servo, const StepFigures& step) {
  RunReport report;
  report.clock = options.clock;
  report.seed = options.seed;
  report.steps = step.steps;
  report.ticks = servo.ticks;
  report.stepTime = step.stepTime;
  report.tickTime = servo.tickTime;
  report.lateness = servo.lateness;
  report.ticksLate = servo.late;
  report.ticksMissed = servo.missed;
  report.contactsMax = step.contactsMax;
  report.forceMax = servo.forceMax;
  report.torqueMax = servo.torqueMax;
  report.penetrationMax = step.penetrationMax;
  report.handEnergy = servo.handEnergy;
  report.handEnergyMin = servo.handEnergyMin;
  report.stepBins = step.stepBins;
  report.tickBins = servo.tickBins;
  report.latenessBins = servo.latenessBins;
  report.recorderDrops = servo.drops + step.drops;
  report.stateHash = step.stateHash;
  return report;
}

}  // namespace palpate
