#include "core/simulation/contact_gathering.h"

#include <algorithm>

namespace palpate {
namespace {

void place(const Eigen::Isometry3d& X, std::span<Contact> contacts, std::uint16_t body) noexcept {
  const Eigen::Matrix3d R = X.linear();
  const Eigen::Vector3d t = X.translation();
  for (Contact& contact : contacts) {
    const Eigen::Vector3d p = R * Eigen::Map<const Eigen::Vector3d>(contact.p) + t;
    const Eigen::Vector3d n = R * Eigen::Map<const Eigen::Vector3d>(contact.n);
    for (int axis = 0; axis < 3; ++axis) {
      contact.p[axis] = p[axis];
      contact.n[axis] = n[axis];
    }
    contact.body = body;
  }
}

}  // namespace

ContactGathering::ContactGathering(std::shared_ptr<const PreparedScene> scene)
    : scene_(std::move(scene)),
      X_W_(scene_->bodies.size() + 1, Eigen::Isometry3d::Identity()),
      sphere_(X_W_.size()),
      sphere_W_(X_W_.size()) {
  const auto bodies = static_cast<std::uint16_t>(scene_->bodies.size());
  sphere_[0].radius = scene_->shell->reach();
  for (std::uint16_t i = 1; i <= bodies; ++i) {
    const auto& points = scene_->bodies[i - 1U].shell->points_T();
    sphere_[i].centre = scene_->bodies[i - 1U].massProperties.p_TC;
    for (const auto& p : points) {
      sphere_[i].radius = std::max(sphere_[i].radius, (p - sphere_[i].centre).norm());
    }
    // The tree's surface is half a voxel out of the shell's centres.
    sphere_[i].radius += scene_->bodies[i - 1U].tree->geometry().spacing.norm();
  }
  planLevels();
  pairs_.reserve(1U + 2U * bodies + bodies * (bodies - std::min(bodies, std::uint16_t{1})) / 2U);
  add(0, kAnatomy);
  for (std::uint16_t i = 1; i <= bodies; ++i) add(0, i);
  for (std::uint16_t i = 1; i <= bodies; ++i) add(i, kAnatomy);
  for (std::uint16_t i = 1; i <= bodies; ++i) {
    for (std::uint16_t j = static_cast<std::uint16_t>(i + 1); j <= bodies; ++j) {
      const bool less =
          scene_->bodies[i - 1U].shell->size() <= scene_->bodies[j - 1U].shell->size();
      add(less ? i : j, less ? j : i);
    }
  }
  // The bodies have room of their own: they never crowd the instrument's contacts out.
  capacity_ = scene_->scene.setting.contactCapacity;
  contacts_.resize(bodies > 0 ? 2 * capacity_ : capacity_);
  sets_.resize(pairs_.size());
}

void ContactGathering::planLevels() {
  const SimulationSetting& own = scene_->scene.setting;
  slots_.push_back(own.query);
  for (const GovernorLevel& level : scene_->levels) {
    const QueryOptions query = settingAt(own, level).query;
    const auto same = [&query](const QueryOptions& slot) {
      return slot.perceptualBound == query.perceptualBound &&
             slot.contactBudget == query.contactBudget && slot.stopLevel == query.stopLevel;
    };
    const auto slot = std::find_if(slots_.begin(), slots_.end(), same);
    slotOf_.push_back(static_cast<std::size_t>(slot - slots_.begin()));
    if (slot == slots_.end()) slots_.push_back(query);
  }
}

void ContactGathering::setLevel(std::size_t level) noexcept {
  if (level >= slotOf_.size() || slotOf_[level] == inUse_) return;
  for (Pair& pair : pairs_) {
    // What is assigned to is empty: nothing is freed.
    pair.others[inUse_] = std::move(pair.finder);
    pair.finder = std::move(pair.others[slotOf_[level]]);
  }
  inUse_ = slotOf_[level];
}

void ContactGathering::add(std::uint16_t body, std::uint16_t other) {
  const PreparedScene& s = *scene_;
  const PointShell& shell = body == 0 ? *s.shell : *s.bodies[body - 1U].shell;
  const VoxelTree& tree = other == kAnatomy ? *s.tree : *s.bodies[other - 1U].tree;
  const Eigen::Isometry3d X_otherV = other == kAnatomy ? s.X_WV : tree.geometry().X_PV;
  const SurfaceTable& surface = body == 0 ? s.instrumentSurface : s.bodies[body - 1U].surface;
  std::vector<ContactFinder> finders;
  finders.reserve(slots_.size());
  for (QueryOptions options : slots_) {
    if (body != 0 || other != kAnatomy) options.threads = 1;
    finders.emplace_back(tree, shell, options);
  }
  ContactFinder own = std::move(finders.front());
  if (finders.size() == 1) finders.clear();
  pairs_.push_back(
      {body, other, std::move(own), std::move(finders), &surface, X_otherV, X_otherV.inverse()});
}

bool ContactGathering::near(const Pair& pair) const noexcept {
  if (pair.other == kAnatomy) return true;  // the finder knows at once what is out of reach
  const Sphere &a = sphere_W_[pair.body], &b = sphere_W_[pair.other];
  const double reach = a.radius + b.radius;
  return (a.centre - b.centre).squaredNorm() <= reach * reach;
}

void ContactGathering::query(Pair& pair) noexcept {
  if (!near(pair)) return;
  const bool still = pair.other == kAnatomy;
  const Eigen::Isometry3d X_WV = still ? pair.X_otherV : X_W_[pair.other] * pair.X_otherV;
  const Eigen::Isometry3d X_VB =
      still ? pair.X_Vother * X_W_[pair.body]
            : pair.X_Vother * (X_W_[pair.other].inverse() * X_W_[pair.body]);
  const std::size_t end = pair.body == 0 ? capacity_ : contacts_.size();
  const std::span<Contact> room(contacts_.data() + count_, end - count_);
  const QueryResult found = pair.finder.find(X_VB, room);
  tests_ += found.tests;
  if (found.status == QueryStatus::OutputFull || found.status == QueryStatus::BudgetSpent) {
    cut_ = true;
  }
  const std::size_t n = std::min(found.contactCount, room.size());
  if (n == 0) return;
  place(X_WV, room.first(n), still ? std::uint16_t{0} : pair.other);
  sets_[setCount_++] = {pair.body, pair.other, room.first(n), pair.surface};
  count_ += n;
}

void ContactGathering::gather(const Eigen::Isometry3d& X_WT,
                              std::span<const Eigen::Isometry3d> X_WB) noexcept {
  X_W_[0] = X_WT;
  std::copy(X_WB.begin(), X_WB.end(), X_W_.begin() + 1);
  for (std::size_t i = 0; X_WB.size() > 0 && i < X_W_.size(); ++i) {
    sphere_W_[i] = {X_W_[i] * sphere_[i].centre, sphere_[i].radius};
  }
  toolCount_ = count_ = setCount_ = 0;
  tests_ = 0;
  cut_ = false;
  for (Pair& pair : pairs_) {
    query(pair);
    if (pair.body == 0) toolCount_ = count_;
  }
}

}  // namespace palpate
