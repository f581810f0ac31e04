#include "core/trade/reference_loop.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/geometry/pose.h"

namespace palpate {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kTick = 1e-3;
constexpr int kParts = 2;
constexpr double kMargin = 0.15e-3;  // m: farther than a point moves in a part at 0.3 m/s
constexpr double kFastestOut = 0.1;  // m/s: a start inside is not shot out
constexpr int kMostSweeps = 400;
constexpr double kLost = 0.1e-3;       // m: ten times what is left where the sweeps settle
constexpr double kConverged = 1e-6;    // m/s: some 1e-4 N for the lightest instrument
constexpr double kDampingRatio = 0.7;  // of the tool on its coupling (core/dynamics/tool_body.h)

Eigen::Matrix3d crossOf(const Eigen::Vector3d& r) {
  Eigen::Matrix3d m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

/// A point that is near: how it moves with the twist of T's origin, and its impulse so far.
struct NearPoint {
  Eigen::Matrix3d frame;                 // rows: normal, two tangents
  Eigen::Matrix<double, 3, 6> jacobian;  // twist to velocity in `frame`
  Eigen::Matrix<double, 6, 3> answer;    // impulse in `frame` to twist
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  double leastSpeed = 0.0;  // m/s along the normal
  double friction = 0.0;
  std::size_t index = 0;  // in the shell
};

/// Points that follow each other in the shell: none is looked at before one may be near.
constexpr std::size_t kBlock = 64;
struct Block {
  double lever = 0.0;  // m, of the farthest from T's origin
  double due = 0.0;    // the first of its points' (Loop::due_)
};

class Loop {
 public:
  Loop(const ReferenceTool& tool, const ReferenceShape& shape) : tool_(tool), shape_(shape) {
    const double arm2 = tool.mass.p_TC.squaredNorm();
    const double inertiaO = tool.mass.I_C.trace() + tool.mass.mass * arm2;
    dampingT_ =
        std::max(tool.damping, 2.0 * kDampingRatio * std::sqrt(tool.stiffness * tool.mass.mass));
    dampingTR_ =
        std::max(tool.dampingR, 2.0 * kDampingRatio * std::sqrt(tool.stiffnessR * inertiaO));
    for (std::size_t i = 0; i < tool.points_T.size(); ++i) {
      if (i % kBlock == 0) blocks_.emplace_back();
      blocks_.back().lever = std::max(blocks_.back().lever, tool.points_T[i].norm());
    }
    due_.assign(tool.points_T.size(), 0.0);
    held_.assign(tool.points_T.size(), Eigen::Vector3d::Zero());
  }

  void reset(const PlainPose& pose) {
    p_ = position(pose);
    q_ = orientation(pose);
    twist_.setZero();
    moved_ = turned_ = 0.0;
    wasOut_ = false;
    for (Block& block : blocks_) block.due = 0.0;
    std::fill(due_.begin(), due_.end(), 0.0);
    std::fill(held_.begin(), held_.end(), Eigen::Vector3d::Zero());
  }

  void tick(const DeviceSample& sample) {
    const double h = kTick / kParts;
    deepest_ = 0.0;
    const Eigen::Vector3d v(sample.v[0], sample.v[1], sample.v[2]);
    const Eigen::Vector3d w(sample.w[0], sample.w[1], sample.w[2]);
    for (int part = 1; part <= kParts; ++part) {
      // Where the hand is at the end of the part.
      const Eigen::Vector3d goal = position(sample.pose) + part * h * v;
      const Eigen::Quaterniond turned = turn(part * h * w) * orientation(sample.pose);
      step(goal, turned, v, w, h);
    }
    wasOut_ = wasOut_ || deepest_ <= kLost;
  }

  [[nodiscard]] PlainPose pose() const { return plain(p_, q_); }
  [[nodiscard]] Eigen::Vector3d v() const { return twist_.head<3>(); }
  [[nodiscard]] Eigen::Vector3d w() const { return twist_.tail<3>(); }
  /// A tool that starts inside has to have been out.
  [[nodiscard]] bool lost() const { return wasOut_ && deepest_ > kLost; }

 private:
  static Eigen::Quaterniond turn(const Eigen::Vector3d& rotation) {
    const double angle = rotation.norm();
    if (angle < 1e-15) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle));
  }

  /// Backward Euler about T's origin: (M + h B + h² K) u = M u0 + h (K e + B u_d).
  void step(const Eigen::Vector3d& goal, const Eigen::Quaterniond& turned, const Eigen::Vector3d& v,
            const Eigen::Vector3d& w, double h) {
    const Eigen::Matrix3d R = q_.toRotationMatrix();
    const Eigen::Vector3d arm = R * tool_.mass.p_TC;
    const double m = tool_.mass.mass;
    Matrix6 inertia = Matrix6::Zero();  // about T's origin
    inertia.topLeftCorner<3, 3>().diagonal().setConstant(m);
    inertia.topRightCorner<3, 3>() = -m * crossOf(arm);
    inertia.bottomLeftCorner<3, 3>() = m * crossOf(arm);
    inertia.bottomRightCorner<3, 3>() =
        R * tool_.mass.I_C * R.transpose() - m * crossOf(arm) * crossOf(arm);
    Vector6 drag, pull;
    drag << Eigen::Vector3d::Constant(dampingT_ + h * tool_.stiffness),
        Eigen::Vector3d::Constant(dampingTR_ + h * tool_.stiffnessR);
    const Eigen::AngleAxisd rest(turned * q_.conjugate());
    const double angle = std::remainder(rest.angle(), 2.0 * 3.14159265358979323846);
    pull << tool_.stiffness * (goal - p_) + dampingT_ * v,
        tool_.stiffnessR * angle * rest.axis() + dampingTR_ * w;
    const Matrix6 system = inertia + h * Matrix6(drag.asDiagonal());
    const Eigen::LDLT<Matrix6> solver(system);
    twist_ = solver.solve(inertia * twist_ + h * pull);
    gather(solver, h);
    relax();
    keepImpulses();
    moved_ += h * twist_.head<3>().norm();
    turned_ += h * twist_.tail<3>().norm();
    p_ += h * twist_.head<3>();
    q_ = (turn(h * Eigen::Vector3d(twist_.tail<3>())) * q_).normalized();
  }

  void gather(const Eigen::LDLT<Matrix6>& solver, double h) {
    near_.clear();
    const Eigen::Matrix3d R = q_.toRotationMatrix();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      Block& block = blocks_[b];
      const double path = moved_ + turned_ * block.lever;
      if (path < block.due) continue;
      const std::size_t end = std::min((b + 1) * kBlock, due_.size());
      block.due = std::numeric_limits<double>::infinity();
      for (std::size_t i = b * kBlock; i < end; ++i) {
        if (path >= due_[i]) {
          const Eigen::Vector3d r = R * tool_.points_T[i];
          const double free = std::max(shape_.clearance(p_ + r, kMargin), 0.0);
          due_[i] = path + free;
          if (free == 0.0) addNear(i, r, solver, h);
        }
        block.due = std::min(block.due, due_[i]);
      }
    }
    startFromHeld();
  }

  void addNear(std::size_t i, const Eigen::Vector3d& r, const Eigen::LDLT<Matrix6>& solver,
               double h) {
    const double d = shape_.distance(p_ + r);
    if (!(d < kMargin)) return;
    deepest_ = std::max(deepest_, -d);
    NearPoint point;
    const Eigen::Vector3d n = shape_.normal(p_ + r);
    const Eigen::Vector3d t = n.unitOrthogonal();
    point.frame << n.transpose(), t.transpose(), n.cross(t).transpose();
    point.jacobian << point.frame, -point.frame * crossOf(r);
    point.answer = solver.solve(point.jacobian.transpose());
    point.leastSpeed = std::min(-d / h, kFastestOut);
    if (tool_.frictionAt) point.friction = tool_.frictionAt(p_ + r);
    point.index = i;
    near_.push_back(point);
  }

  /// Contacts last: the impulses of the part before are close to those of this one.
  void startFromHeld() {
    for (NearPoint& point : near_) {
      point.impulse = point.frame * held_[point.index];
      point.impulse[0] = std::max(point.impulse[0], 0.0);
      twist_ += point.answer * point.impulse;
    }
    for (const std::size_t index : heldBy_) held_[index].setZero();
  }

  void keepImpulses() {
    heldBy_.clear();
    for (const NearPoint& point : near_) {
      held_[point.index] = point.frame.transpose() * point.impulse;
      heldBy_.push_back(point.index);
    }
  }

  /// Projected Gauss-Seidel, until no impulse changes any point's speed by more than a hair.
  void relax() {
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      double most = 0.0;
      for (NearPoint& point : near_) most = std::max(most, improve(point));
      if (most < kConverged) return;
    }
  }

  double improve(NearPoint& point) {
    const Eigen::Vector3d u = point.jacobian * twist_;
    const Eigen::Matrix3d D = point.jacobian * point.answer;
    Eigen::Vector3d wanted = point.impulse;
    wanted[0] = std::max(0.0, point.impulse[0] + (point.leastSpeed - u[0]) / D(0, 0));
    // Friction acts where the surfaces touch, not where they would a part later.
    const double most = point.friction * wanted[0];
    const double slowest = std::max(D(1, 1), D(2, 2));
    wanted[1] -= u[1] / slowest;
    wanted[2] -= u[2] / slowest;
    const double size = std::hypot(wanted[1], wanted[2]);
    if (size > most) {
      wanted[1] *= most / size;
      wanted[2] *= most / size;
    }
    const Eigen::Vector3d change = wanted - point.impulse;
    if (change.isZero(0.0)) return 0.0;
    point.impulse = wanted;
    const Vector6 moved = point.answer * change;
    twist_ += moved;
    return (point.jacobian * moved).norm();
  }

  const ReferenceTool& tool_;
  const ReferenceShape& shape_;
  double dampingT_ = 0.0, dampingTR_ = 0.0;
  double moved_ = 0.0, turned_ = 0.0;  // m and rad, since the reset
  double deepest_ = 0.0;               // m, of the last tick's parts as they began
  bool wasOut_ = false;
  std::vector<Block> blocks_;
  std::vector<double> due_;  // of each point: the path, m, on which it may come near
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Vector6 twist_ = Vector6::Zero();
  std::vector<NearPoint> near_;
  std::vector<Eigen::Vector3d> held_;  // impulses of the part before, W, by shell index
  std::vector<std::size_t> heldBy_;
};

}  // namespace

ReferenceRun runReference(const ReferenceTool& tool, const ReferenceShape& shape,
                          std::span<const DeviceSample> samples) {
  ReferenceRun run;
  Loop loop(tool, shape);
  for (const DeviceSample& sample : samples) {
    if (run.tool.empty()) loop.reset(sample.pose);
    const auto start = std::chrono::steady_clock::now();
    loop.tick(sample);
    const auto spent = std::chrono::steady_clock::now() - start;
    if (loop.lost()) {
      run.settled = false;
      break;
    }
    run.tool.push_back(loop.pose());
    run.v.push_back(loop.v());
    run.w.push_back(loop.w());
    run.micros.push_back(std::chrono::duration<double, std::micro>(spent).count());
  }
  return run;
}

}  // namespace palpate
