#include "tests/stability/closed_loop.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace palpate::stability {
namespace {

/// A ball burr: points over a ball of 3 mm at the tip and along a shaft of 80 mm.
std::vector<Eigen::Vector3d> burrShell() {
  std::vector<Eigen::Vector3d> out;
  constexpr double kRadius = 0.003;
  constexpr int kOnBall = 200;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kOnBall; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kOnBall;
    const double r = std::sqrt(1.0 - z * z);
    out.emplace_back(kRadius * r * std::cos(golden * i), kRadius * r * std::sin(golden * i),
                     kRadius * z);
  }
  for (int i = 0; i < 80; ++i) {
    for (int k = 0; k < 6; ++k) {
      const double a = k * std::numbers::pi / 3.0;
      out.emplace_back(0.001 * std::cos(a), 0.001 * std::sin(a), 0.003 + 0.001 * i);
    }
  }
  return out;
}

/// A slender rod of 120 mm with its tip at the origin of T.
MassProperties rod(double mass) {
  MassProperties m;
  m.mass = mass;
  m.p_TC = {0.0, 0.0, 0.06};
  const double across = mass * 0.12 * 0.12 / 12.0;
  m.I_C = Eigen::Vector3d(across, across, 0.5 * mass * 0.004 * 0.004).asDiagonal();
  return m;
}

std::size_t contactsOf(const Shape& shape, const std::vector<Eigen::Vector3d>& shell_T,
                       const Eigen::Isometry3d& X_WT, const Eigen::Isometry3d& X_WD,
                       std::vector<Contact>& out) {
  std::size_t n = 0;
  const Eigen::Isometry3d X_DW = X_WD.inverse();
  for (std::size_t i = 0; i < shell_T.size(); ++i) {
    const Eigen::Vector3d p_W = X_WT * shell_T[i];
    const Inside in = shape(X_DW * p_W);
    if (!(in.depth > 0.0)) continue;
    const Eigen::Vector3d n_W = X_WD.linear() * in.n;
    Contact& c = out[n++];
    for (int k = 0; k < 3; ++k) {
      c.p[k] = p_W[k];
      c.n[k] = n_W[k];
    }
    c.depth = in.depth;
    c.shellIndex = static_cast<std::uint32_t>(i);
    c.label = 1;
  }
  return n;
}

}  // namespace

Shape wall() {
  return [](const Eigen::Vector3d& p) { return Inside{-p.y(), Eigen::Vector3d::UnitY()}; };
}

Shape ball(double radius) {
  return [radius](const Eigen::Vector3d& p) {
    const Eigen::Vector3d d = p + radius * Eigen::Vector3d::UnitY();
    return Inside{radius - d.norm(), d.normalized()};
  };
}

Shape wedge(double halfAngle, double depth) {
  const Eigen::Vector3d left(std::cos(halfAngle), std::sin(halfAngle), 0.0);
  const Eigen::Vector3d right(-left.x(), left.y(), 0.0);
  return [left, right, depth](const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = p + depth * Eigen::Vector3d::UnitY();
    const double a = -left.dot(q), b = -right.dot(q);
    return a > b ? Inside{a, left} : Inside{b, right};
  };
}

Shape hole(double radius) {
  return [radius](const Eigen::Vector3d& p) {
    const Eigen::Vector3d across(p.x(), 0.0, p.z());
    const double r = across.norm();
    if (r <= radius || p.y() >= 0.0) return Inside{-1.0, Eigen::Vector3d::UnitY()};
    // To the nearer of the floor and the hole's wall.
    return -p.y() < r - radius ? Inside{-p.y(), Eigen::Vector3d::UnitY()}
                               : Inside{r - radius, -across / r};
  };
}

Shape nothing() {
  return [](const Eigen::Vector3d&) { return Inside{-1.0, Eigen::Vector3d::UnitY()}; };
}

LoopResult runLoop(const LoopCase& loop) {
  const double period = loop.arm.period;
  auto made = makeSimulatedPhantom(loop.model, loop.hand ? loop.hand : makeSearchingHand(loop.seed),
                                   loop.seed, loop.grip, loop.arm);
  if (!made) throw std::runtime_error(sentence(made.error()));
  const std::unique_ptr<HapticDevice> held =
      loop.wrap ? loop.wrap(std::move(*made)) : std::move(*made);
  HapticDevice& device = *held;
  if (!device.open()) throw std::runtime_error("the device did not open");

  ServoSettings settings;
  settings.period = period;
  // Not the identity: a mistake in a frame must show.
  settings.X_WD = Eigen::Translation3d(0.1 + loop.faraway, -0.2, 0.3 - loop.faraway) *
                  Eigen::AngleAxisd(0.8, Eigen::Vector3d(1.0, 2.0, -0.5).normalized());
  settings.gains = recommendedGains(device.info(), loop.stepTicks * period);
  settings.gains.stiffness *= loop.gain;
  if (loop.stiffness > 0.0) settings.gains.stiffness = loop.stiffness;
  if (loop.damping >= 0.0) settings.gains.damping = loop.damping;
  settings.limits = recommendedLimits(device.info(), period);
  settings.declaredStepTicks = loop.stepTicks;
  ServoLoop servo(device, settings);

  const std::vector<Eigen::Vector3d> shell = burrShell();
  const double h = loop.stepTicks * period;
  ToolSettings toolSettings;
  toolSettings.coupling = {settings.gains.stiffness, settings.gains.damping,
                           settings.gains.stiffnessR, settings.gains.dampingR};
  toolSettings.reach = 0.083;
  toolSettings.maxTravel = loop.maxTravel;
  ToolBody tool(rod(loop.mass), toolSettings);
  ContactResolver resolver;
  SurfaceTable materials{};
  materials[1] = {loop.toolFriction, 0.0};
  std::vector<Contact> contacts(shell.size());

  LoopResult out;
  out.X_WD = settings.X_WD;
  out.limits = settings.limits;
  const auto ticks = static_cast<std::uint64_t>(std::llround(loop.seconds / period));
  out.samples.reserve(ticks);
  out.tool_D.reserve(ticks);
  ToolState pending;
  bool started = false;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (pending.step > 0 && tick >= pending.dueTick) {
      servo.publishTool(pending);
      pending.step = 0;
    }
    const bool steps = !loop.meddle || loop.meddle(tick, servo);
    out.samples.push_back(servo.tick());
    if (tick % loop.stepTicks != 0 || !steps) continue;
    servo.deviceSamples().refresh();
    const DeviceSample& s = servo.deviceSamples().value();
    if (!started) started = tool.reset(s.pose);

    ToolTarget target;
    target.pose = s.pose;
    for (int i = 0; i < 3; ++i) {
      target.v[i] = s.v[i];
      target.w[i] = s.w[i];
    }
    tool.applyCoupling(target, h);
    const std::size_t n = contactsOf(loop.shape, shell, tool.X_WT(), settings.X_WD, contacts);
    const ContactResponse response = tool.resolve(resolver, {contacts.data(), n}, materials, {}, h);
    tool.advance(h);

    pending = {};
    pending.step = tick / loop.stepTicks + 1;
    pending.deviceSample = s.index;
    pending.dueTick = s.index + loop.stepTicks;
    pending.pose = tool.pose();
    const Eigen::Vector3d v = tool.originVelocity(), w = tool.angularVelocity();
    for (int i = 0; i < 3; ++i) {
      pending.v[i] = v[i];
      pending.w[i] = w[i];
    }
    pending.contacts = static_cast<std::uint32_t>(n);
    for (std::size_t i = 0; i < n; ++i) pending.depth = std::max(pending.depth, contacts[i].depth);

    out.tool_D.push_back(settings.X_WD.inverse() * position(pending.pose));
    out.deepest = std::max(out.deepest, pending.depth);
    if (n > 0) ++out.stepsInContact;
    if (response.capReached) ++out.capsReached;
    out.largestTurn =
        std::max(out.largestTurn,
                 logMap(orientation(pending.pose) * orientation(s.pose).conjugate()).norm());
  }
  device.close();
  return out;
}

}  // namespace palpate::stability
