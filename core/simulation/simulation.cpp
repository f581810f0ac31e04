#include "core/simulation/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/simulation/bits.h"

namespace palpate {
namespace {

ResponseSettings responseOf(const SimulationSetting& setting) {
  ResponseSettings response;
  response.iterations = setting.solverIterations;
  response.friction = setting.friction;
  return response;
}

/// A point that moves no farther at a time cannot get past the middle of a shell of one voxel,
/// beyond which normals point the other way.
double halfVoxelOf(const PreparedScene& scene) {
  double finest = scene.tree->geometry().spacing.minCoeff();
  for (const PreparedBody& body : scene.bodies) {
    finest = std::min(finest, body.tree->geometry().spacing.minCoeff());
  }
  return 0.5 * finest;
}

ToolCoupling toolCoupling(const CouplingGains& gains) noexcept {
  return {gains.stiffness, gains.damping, gains.stiffnessR, gains.dampingR};
}

ToolSettings toolSettings(const PreparedScene& scene, const CouplingGains& gains) {
  ToolSettings settings;
  settings.coupling = toolCoupling(gains);
  settings.maxTravel = halfVoxelOf(scene);
  settings.reach = scene.shell->reach();
  return settings;
}

/// Where the hand is after dt.
PlainPose movedOn(const ToolTarget& target, double dt) noexcept {
  const Eigen::Vector3d v(target.v[0], target.v[1], target.v[2]);
  const Eigen::Vector3d w(target.w[0], target.w[1], target.w[2]);
  return plain(position(target.pose) + dt * v, expMap(dt * w) * orientation(target.pose));
}

std::vector<LooseBody> looseBodies(const PreparedScene& scene) {
  std::vector<LooseBody> bodies;
  for (const PreparedBody& body : scene.bodies) {
    LooseBodySettings settings;
    settings.gravity = scene.scene.surroundings.gravity;
    settings.drag = scene.scene.surroundings.drag;
    settings.maxTravel = halfVoxelOf(scene);
    for (const Eigen::Vector3d& p : body.shell->points_T()) {
      settings.reach = std::max(settings.reach, p.norm());
    }
    bodies.emplace_back(body.massProperties, settings);
    (void)bodies.back().reset(PlainPose{});  // B is W where it starts
  }
  return bodies;
}

void copy(const Eigen::Vector3d& from, double (&to)[3]) noexcept {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

// The servo period that every device here runs at (haptics_facts: Phantoms at 1 kHz).
constexpr double kServoPeriod = 1e-3;
constexpr double kLeastShare = 0.1;
// Parts of a step: at 1 mm and 1 kHz for points of up to 4 m/s, twice what the velocity stop
// allows.
constexpr std::uint32_t kMostParts = 8;
// Slower than 100 steps a second the force fades (servo_loop.h), and simulated time with it.
constexpr double kSlowestPace = 10.0;
// Servo ticks over which the pace that was slowest is forgotten, and the coupling stiffens again.
constexpr double kForget = 1000.0;
// Over so many ticks a coupling that has to give way does so: at once would be felt as a step.
constexpr double kGiveWay = 20.0;

}  // namespace

Simulation::Simulation(std::shared_ptr<const PreparedScene> scene, const CouplingGains& gains)
    : scene_(std::move(scene)),
      gains_(gains),
      halfVoxel_(halfVoxelOf(*scene_)),
      declared_(scene_->scene.setting.stepPeriod),
      h_(declared_),
      stepTicks_(static_cast<std::uint32_t>(std::max(1.0, std::round(declared_ / kServoPeriod)))),
      pace_(stepTicks_),
      userShare_(scene_->scene.setting.couplingShare),
      share_(userShare_),
      userIterations_(scene_->scene.setting.solverIterations),
      response_(responseOf(scene_->scene.setting)),
      body_(scene_->instrument.massProperties, toolSettings(*scene_, softened(gains, share_))),
      bodies_(looseBodies(*scene_)),
      X_WB_(bodies_.size(), Eigen::Isometry3d::Identity()),
      gathering_(scene_),
      resolver_(bodies_.size() + 1),
      moving_(bodies_.size() + 1),
      answered_(bodies_.size() + 1),
      byDepth_(scene_->scene.setting.contactCapacity) {}

void Simulation::apply(const Command& command) noexcept {
  switch (command.kind) {
    case Command::Kind::ResetTool:
      resetWanted_ = true;
      break;
    case Command::Kind::SetSolverIterations:
      // A value that is not a number fails both comparisons and becomes the least.
      userIterations_ = static_cast<std::uint32_t>(
          command.value >= 1.0 ? std::min(command.value, 100000.0) : 1.0);
      limitIterations();
      break;
    case Command::Kind::SetFriction:
      response_.friction = command.value != 0.0;
      break;
    case Command::Kind::SetCoupling:
      userShare_ = command.value >= kLeastShare ? std::min(command.value, 1.0) : kLeastShare;
      break;
    case Command::Kind::SetLevel:
      setLevel(command.value);
      break;
  }
  ++record_.commandCount;
}

void Simulation::setLevel(double value) noexcept {
  if (scene_->levels.empty()) return;
  const auto last = static_cast<double>(scene_->levels.size() - 1);
  // A value that is not a number is the finest.
  const auto level = static_cast<std::size_t>(value >= 0.0 ? std::min(value, last) : 0.0);
  if (level == level_) return;
  level_ = level;
  ++levelChanges_;
  levelSince_ = sample_.t + declared_;
  gathering_.setLevel(level_);
  limitIterations();
}

/// As the user wants; a level that is about impulses has its own, and no more than the user wants.
void Simulation::limitIterations() noexcept {
  const std::uint32_t own = scene_->scene.setting.solverIterations;
  const std::uint32_t ofLevel =
      scene_->levels.empty() ? own : scene_->levels[level_].solverIterations;
  response_.iterations = ofLevel == own           ? userIterations_
                         : userIterations_ == own ? ofLevel
                                                  : std::min(userIterations_, ofLevel);
}

/// How long this step is: from the last sample to this one. Only numbers of samples decide, so that
/// a replay has the same steps.
void Simulation::keepPace(const DeviceSample& sample_W) noexcept {
  const bool next = record_.step > 1 && sample_W.index > sample_.index;
  const double apart = next ? static_cast<double>(sample_W.index - sample_.index) : stepTicks_;
  const double ticks = std::clamp(apart, static_cast<double>(stepTicks_),
                                  std::max(kSlowestPace, static_cast<double>(stepTicks_)));
  h_ = ticks == stepTicks_ ? declared_ : ticks * kServoPeriod;
  pace_ = std::max(ticks, pace_ - kSlowestPace * ticks / kForget);
  softenCoupling();
}

/// Towards what the pace allows: down within a few ticks, up within a second.
void Simulation::softenCoupling() noexcept {
  const double allowed = stiffestFor(pace_ * kServoPeriod) / gains_.stiffness;
  const double wanted = pace_ > stepTicks_ ? std::min(userShare_, allowed) : userShare_;
  if (wanted == share_) return;
  const double ticks = h_ / kServoPeriod;
  share_ = wanted < share_ ? std::max(wanted, share_ - ticks / kGiveWay)
                           : std::min(wanted, share_ + ticks / kForget);
  body_.setCoupling(toolCoupling(coupling()));
}

void Simulation::findContacts() noexcept {
  for (std::size_t i = 0; i < bodies_.size(); ++i) X_WB_[i] = bodies_[i].X_WB();
  gathering_.gather(body_.X_WT(), X_WB_);
  record_.depth = 0.0;
  for (const Contact& contact : contacts_W())
    record_.depth = std::max(record_.depth, contact.depth);
  record_.contacts = static_cast<std::uint32_t>(contacts_W().size());
  record_.contactsBetweenBodies = static_cast<std::uint32_t>(gathering_.betweenBodies());
  record_.tests += gathering_.tests();
}

/// In how many parts, by what moves fastest. The tool may speed up within the step: a fifth in
/// hand, and ToolBody caps the rest.
std::uint32_t Simulation::partsFor(const DeviceSample& sample_W) const noexcept {
  constexpr double kInHand = 1.2;
  const double reach = body_.settings().reach;
  const auto speed = [](const double(&v)[3]) { return std::hypot(v[0], v[1], v[2]); };
  double fastest = std::max(speed(sample_W.v) + reach * speed(sample_W.w),
                            body_.originVelocity().norm() + reach * body_.angularVelocity().norm());
  for (const LooseBody& body : bodies_) fastest = std::max(fastest, body.fastest());
  const double parts = std::ceil(kInHand * fastest * h_ / halfVoxel_);
  if (!(parts > 1.0)) return 1;
  return parts < kMostParts ? static_cast<std::uint32_t>(parts) : kMostParts;
}

void Simulation::stepPart(const ToolTarget& target, double dt) noexcept {
  body_.applyCoupling(target, dt);
  for (LooseBody& body : bodies_) body.accelerate(dt);
  findContacts();
  resolveContacts(dt);
  body_.advance(dt);
  for (LooseBody& body : bodies_) body.advance(dt);
}

void Simulation::resolveContacts(double dt) noexcept {
  moving_[0] = body_.contactBody();
  for (std::size_t i = 0; i < bodies_.size(); ++i) moving_[i + 1] = bodies_[i].contactBody();
  effort_ = resolver_.resolve(moving_, gathering_.sets(), response_, dt, answered_);
  record_.impulses += effort_.iterations;
  body_.take(answered_[0], !contacts_W().empty(), dt);
  for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i].take(answered_[i + 1], dt);
}

const StepRecord& Simulation::step(const DeviceSample& sample_W) noexcept {
  const auto start = std::chrono::steady_clock::now();
  ++record_.step;
  keepPace(sample_W);
  sample_ = sample_W;
  record_.deviceSample = sample_W.index;
  if (resetWanted_) resetWanted_ = !body_.reset(sample_W.pose);
  ToolTarget target;
  target.pose = sample_W.pose;
  std::memcpy(target.v, sample_W.v, sizeof(target.v));
  std::memcpy(target.w, sample_W.w, sizeof(target.w));
  const std::uint32_t parts = partsFor(sample_W);
  const double dt = parts == 1 ? h_ : h_ / parts;
  record_.parts = parts;
  record_.tests = record_.impulses = 0;
  for (std::uint32_t part = 0; part < parts; ++part) {
    if (part > 0) target.pose = movedOn(target, dt);
    stepPart(target, dt);
  }
  publish(sample_W);
  chainHash();
  const auto spent = std::chrono::steady_clock::now() - start;
  record_.micros = std::chrono::duration<double, std::micro>(spent).count();
  return record_;
}

void Simulation::publish(const DeviceSample& sample_W) noexcept {
  record_.h = h_;
  record_.level = static_cast<std::uint32_t>(level_);
  record_.stiffness = coupling().stiffness;
  record_.tool = body_.pose();
  copy(body_.originVelocity(), record_.v);
  copy(body_.angularVelocity(), record_.w);
  const Vector6d& wrench = body_.contactWrench();
  copy(wrench.head<3>(), record_.contact.force);
  copy(wrench.tail<3>(), record_.contact.torque);

  tool_.step = record_.step;
  tool_.deviceSample = sample_W.index;
  tool_.paceTicks = static_cast<std::uint32_t>(std::ceil(pace_));
  tool_.dueTick = sample_W.index + static_cast<std::uint64_t>(std::lround(h_ / kServoPeriod));
  tool_.stiffnessShare = share_;
  tool_.pose = record_.tool;
  std::memcpy(tool_.v, record_.v, sizeof(tool_.v));
  std::memcpy(tool_.w, record_.w, sizeof(tool_.w));
  tool_.coupling = couplingWrench(coupling(), tool_.pose, tool_.v, tool_.w, sample_W);
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
  for (const LooseBody& body : bodies_) {
    BitRow<16> moved;
    const PlainPose pose = body.pose();
    moved.add(pose.p);
    moved.add(pose.q);
    for (int axis = 0; axis < 3; ++axis) moved.add(body.body().velocity()[axis]);
    for (int axis = 0; axis < 3; ++axis) moved.add(body.body().angularMomentum()[axis]);
    record_.stateHash = moved.hash(record_.stateHash);
  }
}

void Simulation::fill(Snapshot& snapshot) noexcept {
  snapshot.step = record_.step;
  snapshot.tick = sample_.index;
  snapshot.t = sample_.t + declared_;
  snapshot.tool = record_.tool;
  snapshot.device = sample_.pose;
  snapshot.contact = record_.contact;
  snapshot.contacts = record_.contacts;
  snapshot.depth = record_.depth;
  snapshot.coupling = coupling();
  snapshot.stepPeriod = h_;
  const std::size_t bodies = std::min(bodies_.size(), Snapshot::kBodiesDrawn);
  snapshot.bodies = static_cast<std::uint32_t>(bodies);
  for (std::size_t i = 0; i < bodies; ++i) snapshot.body[i] = bodies_[i].pose();
  fillLevel(snapshot);
  fillContacts(snapshot);
}

void Simulation::fillLevel(Snapshot& snapshot) noexcept {
  snapshot.levels = static_cast<std::uint32_t>(scene_->levels.size());
  snapshot.level = static_cast<std::uint32_t>(level_);
  snapshot.levelChanges = levelChanges_;
  snapshot.levelSince = levelSince_;
  snapshot.levelName.fill(0);
  if (scene_->levels.empty()) return;
  const std::string& name = scene_->levels[level_].name;
  std::copy_n(name.begin(), std::min(name.size(), snapshot.levelName.size() - 1),
              snapshot.levelName.begin());
}

/// All, or the deepest where they are many.
void Simulation::fillContacts(Snapshot& snapshot) noexcept {
  const std::span<const Contact> contacts = contacts_W();
  const std::size_t drawn = std::min(contacts.size(), Snapshot::kContactsDrawn);
  snapshot.contactsDrawn = static_cast<std::uint32_t>(drawn);
  if (drawn == contacts.size()) {
    std::copy_n(contacts.begin(), drawn, snapshot.contact_W.begin());
    return;
  }
  const auto end = byDepth_.begin() + static_cast<std::ptrdiff_t>(contacts.size());
  std::iota(byDepth_.begin(), end, 0U);
  std::nth_element(byDepth_.begin(), byDepth_.begin() + static_cast<std::ptrdiff_t>(drawn), end,
                   [contacts](std::uint32_t a, std::uint32_t b) {
                     return contacts[a].depth > contacts[b].depth;
                   });
  for (std::size_t c = 0; c < drawn; ++c) snapshot.contact_W[c] = contacts[byDepth_[c]];
}

}  // namespace palpate
