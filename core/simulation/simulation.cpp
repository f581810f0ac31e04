#include "core/simulation/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/simulation/bits.h"

namespace palpate {
namespace {

SurfaceTable surfacesOf(const PreparedScene& scene) {
  SurfaceTable table;
  for (std::size_t label = 0; label < table.size(); ++label) {
    table[label] = {scene.materialOf[label].friction, scene.materialOf[label].restitution};
  }
  return table;
}

ResponseSettings responseOf(const SimulationSetting& setting) {
  ResponseSettings response;
  response.iterations = setting.solverIterations;
  response.friction = setting.friction;
  return response;
}

ToolSettings toolSettings(const PreparedScene& scene, const CouplingGains& gains) {
  ToolSettings settings;
  settings.coupling = {gains.stiffness, gains.damping, gains.stiffnessR, gains.dampingR};
  settings.maxTravel = scene.tree->geometry().spacing.minCoeff();
  settings.reach = scene.shell->reach();
  return settings;
}

void copy(const Eigen::Vector3d& from, double (&to)[3]) noexcept {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

// The servo period that every device here runs at (haptics_facts: Phantoms at 1 kHz).
constexpr double kServoPeriod = 1e-3;

}  // namespace

Simulation::Simulation(std::shared_ptr<const PreparedScene> scene, const CouplingGains& gains)
    : scene_(std::move(scene)),
      gains_(gains),
      X_WV_(scene_->X_WV),
      X_VW_(scene_->X_WV.inverse()),
      h_(scene_->scene.setting.stepPeriod),
      stepTicks_(static_cast<std::uint32_t>(
          std::max(1.0, std::round(scene_->scene.setting.stepPeriod / kServoPeriod)))),
      surfaces_(surfacesOf(*scene_)),
      response_(responseOf(scene_->scene.setting)),
      body_(scene_->instrument.massProperties, toolSettings(*scene_, gains)),
      finder_(*scene_->tree, *scene_->shell, scene_->scene.setting.query),
      contacts_(scene_->scene.setting.contactCapacity),
      byDepth_(scene_->scene.setting.contactCapacity) {}

void Simulation::apply(const Command& command) noexcept {
  switch (command.kind) {
    case Command::Kind::ResetTool:
      resetWanted_ = true;
      break;
    case Command::Kind::SetSolverIterations:
      // A value that is not a number fails both comparisons and becomes the least.
      response_.iterations = static_cast<std::uint32_t>(
          command.value >= 1.0 ? std::min(command.value, 100000.0) : 1.0);
      break;
    case Command::Kind::SetFriction:
      response_.friction = command.value != 0.0;
      break;
    case Command::Kind::SetCoupling:
      break;
  }
  ++record_.commandCount;
}

void Simulation::findContacts() noexcept {
  const QueryResult found = finder_.find(X_VW_ * body_.X_WT(), contacts_);
  contactCount_ = std::min(found.contactCount, contacts_.size());
  contactsCut_ =
      found.status == QueryStatus::OutputFull || found.status == QueryStatus::BudgetSpent;
  record_.depth = 0.0;
  const Eigen::Matrix3d R_WV = X_WV_.linear();
  const Eigen::Vector3d p_WV = X_WV_.translation();
  for (std::size_t c = 0; c < contactCount_; ++c) {
    Contact& contact = contacts_[c];
    const Eigen::Vector3d p = R_WV * Eigen::Map<const Eigen::Vector3d>(contact.p) + p_WV;
    const Eigen::Vector3d n = R_WV * Eigen::Map<const Eigen::Vector3d>(contact.n);
    copy(p, contact.p);
    copy(n, contact.n);
    record_.depth = std::max(record_.depth, contact.depth);
  }
  record_.contacts = static_cast<std::uint32_t>(contactCount_);
}

const StepRecord& Simulation::step(const DeviceSample& sample_W) noexcept {
  const auto start = std::chrono::steady_clock::now();
  sample_ = sample_W;
  ++record_.step;
  record_.deviceSample = sample_W.index;
  if (resetWanted_) resetWanted_ = !body_.reset(sample_W.pose);
  ToolTarget target;
  target.pose = sample_W.pose;
  std::memcpy(target.v, sample_W.v, sizeof(target.v));
  std::memcpy(target.w, sample_W.w, sizeof(target.w));
  body_.applyCoupling(target, h_);
  findContacts();
  (void)body_.resolve(resolver_, contacts_W(), surfaces_, response_, h_);
  body_.advance(h_);
  publish(sample_W);
  chainHash();
  const auto spent = std::chrono::steady_clock::now() - start;
  record_.micros = std::chrono::duration<double, std::micro>(spent).count();
  return record_;
}

void Simulation::publish(const DeviceSample& sample_W) noexcept {
  record_.tool = body_.pose();
  copy(body_.originVelocity(), record_.v);
  copy(body_.angularVelocity(), record_.w);
  const Vector6d& wrench = body_.contactWrench();
  copy(wrench.head<3>(), record_.contact.force);
  copy(wrench.tail<3>(), record_.contact.torque);

  const Wrench before = tool_.coupling;
  const bool first = tool_.step == 0;
  tool_.step = record_.step;
  tool_.deviceSample = sample_W.index;
  tool_.dueTick = sample_W.index + stepTicks_;
  tool_.pose = record_.tool;
  std::memcpy(tool_.v, record_.v, sizeof(tool_.v));
  std::memcpy(tool_.w, record_.w, sizeof(tool_.w));
  tool_.coupling = couplingWrench(gains_, tool_.pose, tool_.v, tool_.w, sample_W);
  for (std::size_t axis = 0; axis < 3 && !first; ++axis) {
    tool_.couplingRate.force[axis] = (tool_.coupling.force[axis] - before.force[axis]) / h_;
    tool_.couplingRate.torque[axis] = (tool_.coupling.torque[axis] - before.torque[axis]) / h_;
  }
  tool_.contacts = record_.contacts;
  tool_.depth = record_.depth;
}

void Simulation::chainHash() noexcept {
  BitRow<32> row;
  row.add(record_.step);
  row.add(record_.deviceSample);
  row.add(record_.commandCount);
  row.add(record_.tool.p);
  row.add(record_.tool.q);
  row.add(record_.v);
  row.add(record_.w);
  row.add(record_.contact.force);
  row.add(record_.contact.torque);
  row.add(record_.contacts);
  row.add(record_.depth);
  record_.stateHash = row.hash(record_.stateHash);
}

void Simulation::fill(Snapshot& snapshot) noexcept {
  snapshot.step = record_.step;
  snapshot.tick = sample_.index;
  snapshot.t = static_cast<double>(record_.step) * h_;
  snapshot.tool = record_.tool;
  snapshot.device = sample_.pose;
  snapshot.contact = record_.contact;
  snapshot.contacts = record_.contacts;
  snapshot.depth = record_.depth;
  snapshot.coupling = gains_;
  snapshot.stepPeriod = h_;
  const std::size_t drawn = std::min(contactCount_, Snapshot::kContactsDrawn);
  snapshot.contactsDrawn = static_cast<std::uint32_t>(drawn);
  if (drawn == contactCount_) {
    std::copy_n(contacts_.begin(), drawn, snapshot.contact_W.begin());
    return;
  }
  const auto end = byDepth_.begin() + static_cast<std::ptrdiff_t>(contactCount_);
  std::iota(byDepth_.begin(), end, 0U);
  std::nth_element(
      byDepth_.begin(), byDepth_.begin() + static_cast<std::ptrdiff_t>(drawn), end,
      [this](std::uint32_t a, std::uint32_t b) { return contacts_[a].depth > contacts_[b].depth; });
  for (std::size_t c = 0; c < drawn; ++c) snapshot.contact_W[c] = contacts_[byDepth_[c]];
}

}  // namespace palpate
