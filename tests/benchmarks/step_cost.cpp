/// What a whole servo tick and a whole simulation step cost at 10, 100, 1,000 and 10,000 contacts,
/// and what the response alone costs beside the paper's loop taken literally (every impulse looks
/// at every contact). The instrument is pressed into bone by a held device; voxels of the program's
/// own tree, response and hash as shipped.
///
///     cmake --build --preset release --target step_cost &&
///     build/release/tests/benchmarks/step_cost

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "core/devices/simulated_phantom.h"
#include "core/haptics/servo_loop.h"
#include "core/scene/instrument_mesh.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

constexpr int kRuns = 4000;

struct Cost {
  double p50 = 0, p99 = 0, worst = 0;
};

Cost costOf(std::vector<double> micros) {
  std::sort(micros.begin(), micros.end());
  return {micros[micros.size() / 2], micros[micros.size() * 99 / 100], micros.back()};
}

double microsOf(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

/// The paper's loop as it is written: of all contacts the deepest that approaches, an impulse,
/// again.
struct Literal {
  Vector6d twist;
  std::uint32_t impulses = 0;

  void resolve(const ContactBody& body, std::span<const Contact> contacts, double friction,
               std::uint32_t most) {
    twist = body.twist;
    for (impulses = 0; impulses < most; ++impulses) {
      const Contact* deepest = nullptr;
      for (const Contact& c : contacts) {
        const Eigen::Vector3d r = Eigen::Map<const Eigen::Vector3d>(c.p) - body.p_WC;
        const Eigen::Vector3d u = twist.head<3>() + twist.tail<3>().cross(r);
        const bool approaches = u.dot(Eigen::Map<const Eigen::Vector3d>(c.n)) < -1e-5;
        if (approaches && (deepest == nullptr || c.depth > deepest->depth)) deepest = &c;
      }
      if (deepest == nullptr) return;
      push(body, *deepest, friction);
    }
  }
  void push(const ContactBody& body, const Contact& c, double friction) {
    const Eigen::Vector3d r = Eigen::Map<const Eigen::Vector3d>(c.p) - body.p_WC;
    const Eigen::Map<const Eigen::Vector3d> n(c.n);
    Eigen::Matrix<double, 6, 3> Pt;
    Pt.topRows<3>().setIdentity();
    Pt.bottomRows<3>() << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    const Eigen::Matrix3d K = Pt.transpose() * body.mobility * Pt;
    const Eigen::Vector3d u = twist.head<3>() + twist.tail<3>().cross(r);
    const Eigen::Vector3d tangent = u - u.dot(n) * n;
    const double slip = tangent.norm();
    const Eigen::Vector3d direction =
        slip > 1e-9 ? Eigen::Vector3d(-tangent / slip) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const double jn = -u.dot(n) / n.dot(K * n);
    const double jt = std::min(friction * jn, slip / std::max(1e-12, direction.dot(K * direction)));
    twist += body.mobility * Pt * (jn * n + jt * direction);
  }
};

/// Bone: everything below y = 0, and 60 mm of it about the origin.
std::shared_ptr<const LabelGrid> slab() {
  auto grid = std::make_shared<LabelGrid>();
  grid->geometry.dims = {121, 64, 121};
  grid->geometry.spacing.setConstant(0.5e-3);
  grid->geometry.X_PV = Eigen::Translation3d(-0.03, -0.028, -0.03);
  grid->labels.assign(grid->geometry.voxelCount(), 0);
  for (std::int32_t k = 0; k < 121; ++k) {
    for (std::int32_t j = 0; j < 56; ++j) {
      for (std::int32_t i = 0; i < 121; ++i) grid->labels[grid->geometry.index(i, j, k)] = 1;
    }
  }
  return grid;
}

/// A flat rod of 20 mm across whose end has about so many points within 20 mm of its rim.
Instrument plate(double spacing) {
  const auto section = [](double z) {
    CrossSection s;
    s.p_T = {0, 0, z};
    s.halfAxes = {0.01, 0.01};
    return s;
  };
  Instrument out;
  out.name = "plate";
  out.mesh_T = *sweepSections({section(0), section(0.03)}, 64);
  out.massProperties = *massPropertiesOf(out.mesh_T, 1000.0);
  out.shellSpacing = spacing;
  return out;
}

std::shared_ptr<const PreparedScene> sceneWith(double spacing) {
  Scene scene;
  scene.X_WD = Eigen::Isometry3d::Identity();
  Material bone;
  bone.name = "bone";
  bone.friction = 0.25;
  auto made =
      prepareScene(scene, slab(), {{"bone", 1, {227, 211, 177}, "bone"}}, {bone}, plate(spacing));
  if (!made) {
    std::fprintf(stderr, "%s\n", sentence(made.error()).c_str());
    std::exit(4);
  }
  return *made;
}

/// Upright, the end `depth` metres in the bone, swaying a little so that contacts change.
DeviceSample pressed(std::uint64_t tick, double depth) {
  DeviceSample s;
  s.index = tick;
  const double a = 0.002 * std::sin(0.02 * static_cast<double>(tick));
  const Eigen::Quaterniond upright =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
  s.pose = plain(Eigen::Vector3d(a, -depth, 0.5 * a),
                 (expMap({0.3 * a, 0, -0.2 * a}) * upright).normalized());
  return s;
}

void row(std::size_t wanted) {
  // The end is 20 mm across: about pi r^2 / spacing^2 points; a rim of the side sinks in with it.
  const double spacing = 0.01 * std::sqrt(M_PI / static_cast<double>(wanted)) * 1.13;
  const auto scene = sceneWith(std::clamp(spacing, 5e-5, 5e-3));
  Simulation simulation(scene, CouplingGains{});
  std::vector<double> step, response, literal;
  std::vector<double> contacts;
  ContactResolver resolver;
  Literal plainly;
  std::uint32_t ours = 0, theirs = 0;
  for (std::uint64_t tick = 0; tick < kRuns; ++tick) {
    const DeviceSample sample = pressed(tick, 0.001);
    step.push_back(microsOf([&] { (void)simulation.step(sample); }));
    contacts.push_back(static_cast<double>(simulation.contacts_W().size()));
    if (tick % 8 != 0) continue;
    // The same contacts once more, for a body that comes down on them at 5 cm/s, turning.
    ContactBody body;
    body.p_WC = {0, 0.014, 0};
    body.twist << 0.01, -0.05, 0.005, 0.3, 0.1, -0.2;
    body.mobility.setZero();
    body.mobility.diagonal() << 20, 20, 20, 1e5, 2e5, 1e5;
    response.push_back(microsOf([&] {
      ours = resolver
                 .resolveContacts(body, simulation.contacts_W(), scene->instrumentSurface, {}, 1e-3)
                 .iterations;
    }));
    literal.push_back(microsOf([&] {
      plainly.resolve(body, simulation.contacts_W(), 0.25, 200);
      theirs = plainly.impulses;
    }));
  }
  std::sort(contacts.begin(), contacts.end());
  const Cost s = costOf(step), r = costOf(response), l = costOf(literal);
  std::printf("| %.0f | %.1f / %.1f / %.1f | %.1f / %.1f (%u) | %.1f / %.1f (%u) | %.2f | %.0f |\n",
              contacts[contacts.size() / 2], s.p50, s.p99, s.worst, r.p50, r.p99, ours, l.p50,
              l.p99, theirs, l.p50 / r.p50,
              1e3 * r.p50 / std::max(1.0, contacts[contacts.size() / 2]));
}

/// A device that answers at once, as hardware's driver would.
class ReadyDevice final : public HapticDevice {
 public:
  const DeviceInfo& info() const noexcept override { return info_; }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  DeviceSample read(std::uint64_t tick) noexcept override {
    DeviceSample s = pressed(tick, 0.001);
    s.buttons = 1;
    return s;
  }
  void write(const Wrench& wrench) noexcept override { last_ = wrench; }

 private:
  DeviceInfo info_;
  Wrench last_;
};

void servoRow() {
  ReadyDevice device;
  ServoLoop servo(device, {});
  std::vector<double> micros;
  for (std::uint64_t tick = 0; tick < 20000; ++tick) {
    ToolState tool;
    tool.step = tick + 1;
    tool.dueTick = tick;
    tool.contacts = tick > 100 ? 10 : 0;
    servo.publishTool(tool);
    micros.push_back(microsOf([&] { (void)servo.tick(); }));
  }
  const Cost c = costOf(micros);
  std::printf(
      "\nServo tick, whole (it does not depend on contacts): p50 %.2f, p99 %.2f, worst %.1f us\n",
      c.p50, c.p99, c.worst);
}

}  // namespace
}  // namespace palpate

int main() {
  std::printf(
      "| contacts | step p50 / p99 / worst (us) | response p50 / p99 (impulses) | "
      "paper's loop literally p50 / p99 (impulses) | ratio | ns a contact |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const std::size_t contacts : {10U, 100U, 1000U, 10000U}) palpate::row(contacts);
  palpate::servoRow();
  return 0;
}
