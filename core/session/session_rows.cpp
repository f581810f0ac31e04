#include "core/session/session_rows.h"

namespace palpate {
namespace {

// One list of fields for each row, walked by packing and unpacking alike: they cannot disagree.
template <class Visitor, class Sample>
void visitSample(Visitor&& visit, Sample& s) {
  visit(s.device.index);
  visit(s.device.t);
  visit(s.device.pose.p);
  visit(s.device.pose.q);
  visit(s.device.v);
  visit(s.device.w);
  visit(s.device.buttons);
  visit(s.device.status);
  visit(s.wrench.force);
  visit(s.wrench.torque);
  visit(s.toolStep);
  visit(s.contacts);
  visit(s.depth);
  visit(s.state);
  visit(s.fault);
  visit(s.handEnergy);
}

template <class Visitor, class Step>
void visitStep(Visitor&& visit, Step& s) {
  visit(s.step);
  visit(s.deviceSample);
  visit(s.stateHash);
  visit(s.commandCount);
  visit(s.tool.p);
  visit(s.tool.q);
  visit(s.v);
  visit(s.w);
  visit(s.contact.force);
  visit(s.contact.torque);
  visit(s.contacts);
  visit(s.depth);
  visit(s.micros);
}

template <class Visitor, class T>
void visitTiming(Visitor&& visit, T& timing) {
  visit(timing.p50);
  visit(timing.p99);
  visit(timing.p999);
  visit(timing.max);
}

template <class Visitor, class Report>
void visitReport(Visitor&& visit, Report& r) {
  visit(r.clock);
  visit(r.seed);
  visit(r.steps);
  visit(r.ticks);
  visitTiming(visit, r.stepTime);
  visitTiming(visit, r.tickTime);
  visitTiming(visit, r.lateness);
  visit(r.ticksLate);
  visit(r.ticksMissed);
  visit(r.contactsMax);
  visit(r.forceMax);
  visit(r.torqueMax);
  visit(r.penetrationMax);
  visit(r.handEnergy);
  visit(r.recorderDrops);
  visit(r.stateHash);
  visit(r.realTimePriority);
  visit(r.realTimeNote);
}

template <class Visitor, class Gains>
void visitGains(Visitor&& visit, Gains& g) {
  visit(g.stiffness);
  visit(g.damping);
  visit(g.stiffnessR);
  visit(g.dampingR);
}

auto putter(Packer& to) {
  return [&to](const auto& field) { to.put(field); };
}
auto getter(Unpacker& from) {
  return [&from](auto& field) { from.get(field); };
}

}  // namespace

void pack(Packer& to, const ServoSample& sample) {
  visitSample(putter(to), sample);
}
void pack(Packer& to, const StepRecord& step) {
  visitStep(putter(to), step);
}
void pack(Packer& to, const RunReport& report) {
  visitReport(putter(to), report);
}
void pack(Packer& to, const CouplingGains& gains) {
  visitGains(putter(to), gains);
}

std::optional<ServoSample> unpackSample(std::span<const std::uint8_t> bytes) {
  Unpacker from(bytes);
  ServoSample sample;
  visitSample(getter(from), sample);
  if (!from.finished()) return std::nullopt;
  return sample;
}

std::optional<StepRecord> unpackStep(std::span<const std::uint8_t> bytes) {
  Unpacker from(bytes);
  StepRecord step;
  visitStep(getter(from), step);
  if (!from.finished()) return std::nullopt;
  return step;
}

std::optional<RunReport> unpackReport(std::span<const std::uint8_t> bytes) {
  Unpacker from(bytes);
  RunReport report;
  visitReport(getter(from), report);
  if (!from.finished()) return std::nullopt;
  return report;
}

std::optional<CouplingGains> unpackGains(std::span<const std::uint8_t> bytes) {
  Unpacker from(bytes);
  CouplingGains gains;
  visitGains(getter(from), gains);
  if (!from.finished()) return std::nullopt;
  return gains;
}

}  // namespace palpate
