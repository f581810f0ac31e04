#include "app/run_sinks.h"

#include <array>
#include <cstdio>

#include "core/geometry/units.h"

namespace palpate {
namespace {

constexpr const char* kHeading =
    "t_s,x_m,y_m,z_m,qw,qx,qy,qz,vx,vy,vz,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,contacts,depth_m,step\n";

/// Nine significant digits: below an encoder's step, and the same text on every machine.
void appendNumber(std::string& text, double value) {
  std::array<char, 40> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.9g,", value);
  text += buffer.data();
}

}  // namespace

bool SampleSink::onTick(const ServoSample& sample) noexcept {
  if (rows_.size() == rows_.capacity()) {
    ++dropped_;
    return false;
  }
  rows_.push_back(sample);  // within the reserved room: no allocation
  return true;
}

std::string SampleSink::csv() const {
  std::string text = kHeading;
  text.reserve(text.size() + rows_.size() * 200);
  for (const ServoSample& row : rows_) {
    const DeviceSample& device = row.device;
    appendNumber(text, device.t);
    for (const double x : device.pose.p) appendNumber(text, x);
    for (const double q : device.pose.q) appendNumber(text, q);
    for (const double v : device.v) appendNumber(text, v);
    for (const double f : row.wrench.force) appendNumber(text, f);
    for (const double t : row.wrench.torque) appendNumber(text, t);
    text += std::to_string(row.contacts) + ",";
    appendNumber(text, row.depth);
    text += std::to_string(row.toolStep) + "\n";
  }
  return text;
}

bool StepSink::onStep(const StepRecord& step) noexcept {
  if (rows_.size() == rows_.capacity()) {
    ++dropped_;
    return false;
  }
  rows_.push_back(step);
  return true;
}

std::string StepSink::csv() const {
  std::string text =
      "step,step_ms,parts,contacts,body_contacts,depth_mm,tests,impulses,time_us,stiffness_N_per_"
      "m\n";
  text.reserve(text.size() + rows_.size() * 80);
  for (const StepRecord& row : rows_) {
    text += std::to_string(row.step) + ",";
    appendNumber(text, 1e3 * row.h);
    text += std::to_string(row.parts) + "," + std::to_string(row.contacts) + "," +
            std::to_string(row.contactsBetweenBodies) + ",";
    appendNumber(text, millimetres(row.depth));
    text += std::to_string(row.tests) + "," + std::to_string(row.impulses) + ",";
    appendNumber(text, row.micros);
    appendNumber(text, row.stiffness);
    text.back() = '\n';
  }
  return text;
}

bool BodySink::onBodies(std::uint64_t step, std::span<const LooseBody> bodies) noexcept {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (rows_.size() == rows_.capacity()) {
      dropped_ += bodies.size() - i;
      return false;
    }
    Row& row = rows_.emplace_back();
    row.step = step;
    row.body = i + 1;
    row.pose = bodies[i].pose();
    for (int axis = 0; axis < 3; ++axis) row.centre[axis] = bodies[i].body().centre()[axis];
  }
  return true;
}

std::string BodySink::csv() const {
  std::string text = "step,body,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
  for (const Row& row : rows_) {
    text += std::to_string(row.step) + "," + std::to_string(row.body) + ",";
    for (const double x : row.centre) appendNumber(text, millimetres(x));
    for (const double q : row.pose.q) appendNumber(text, q);
    text.back() = '\n';
  }
  return text;
}

bool TeeSink::onBodies(std::uint64_t step, std::span<const LooseBody> bodies) noexcept {
  bool taken = true;
  for (RunSink* sink : sinks_) taken = sink->onBodies(step, bodies) && taken;
  return taken;
}

bool TeeSink::onTick(const ServoSample& sample) noexcept {
  bool taken = true;
  for (RunSink* sink : sinks_) taken = sink->onTick(sample) && taken;
  return taken;
}

bool TeeSink::onStep(const StepRecord& step) noexcept {
  bool taken = true;
  for (RunSink* sink : sinks_) taken = sink->onStep(step) && taken;
  return taken;
}

bool TeeSink::onCommand(std::uint64_t step, const Command& command) noexcept {
  bool taken = true;
  for (RunSink* sink : sinks_) taken = sink->onCommand(step, command) && taken;
  return taken;
}

}  // namespace palpate
