#include "core/simulation/governor.h"

#include <algorithm>
#include <functional>

namespace palpate {
namespace {

// What a level is predicted to take may be so much of the budget: less on the way up, so that a
// level that was left for a load is not taken again under the same one.
constexpr double kFitDown = 0.9, kFitUp = 0.75;
// One step in fifty may be late for as long as it likes; more of them, four in hand, and the level
// goes down though no three came together.
constexpr double kMayBeLate = 1.0 / 50.0, kLateInHand = 4.0;
// Of a wait's steps: so many may not fit, and one besides.
constexpr double kMayBeUnfit = 0.01;

}  // namespace

Governor::Governor(std::span<const GovernorLevel> levels, double stepPeriod,
                   const GovernorSettings& settings) noexcept
    : levels_(std::min(levels.size(), kMostLevels)),
      period_(stepPeriod),
      budget_us_(1e6 * settings.headroom * stepPeriod),
      settings_(settings) {
  wait_.fill(settings.leastWait);
  for (std::size_t i = 0; i < levels_; ++i) predicted_us_[i] = levels[i].stepP99_us;
}

void Governor::moveTo(std::size_t level) noexcept {
  level_ = std::min(level, levels_ - 1);
  trying_ = false;
  startAnew();
}

/// What was seen of one level says nothing of another.
void Governor::startAnew() noexcept {
  recent_.fill(0.0);
  late_ = calm_ = unfit_ = 0.0;
}

void Governor::note(double step_us, double stepLength) noexcept {
  recent_[next_] = step_us;
  next_ = (next_ + 1) % kRecent;
  late_ = step_us > budget_us_ ? late_ + 1.0 : std::max(0.0, late_ - kMayBeLate);
  tried_ += stepLength;
  if (trying_ && tried_ >= std::max(settings_.trial, wait_[level_])) {
    trying_ = false;
    std::fill(wait_.begin() + static_cast<std::ptrdiff_t>(level_), wait_.end(),
              settings_.leastWait);
  }
  if (level_ == 0) return;
  calm_ += stepLength;
  const double finer_us = step_us * (predicted_us_[level_ - 1] / predicted_us_[level_]);
  if (!(finer_us <= kFitUp * budget_us_)) unfit_ += 1.0;
}

/// In the wait for the finer level; not asked at the finest.
double Governor::mayBeUnfit() const noexcept {
  return 1.0 + kMayBeUnfit * wait_[level_ - 1] / period_;
}

/// The finest below this one that the recent steps would have fitted at, the slowest of them left
/// out; the last where none does.
std::size_t Governor::levelThatFits() const noexcept {
  std::array<double, kRecent> slowest = recent_;
  std::nth_element(slowest.begin(), slowest.begin() + 1, slowest.end(), std::greater<>());
  const double scale = slowest[1] / predicted_us_[level_];
  std::size_t level = level_ + 1;
  while (level + 1 < levels_ && !(scale * predicted_us_[level] <= kFitDown * budget_us_)) ++level;
  return level;
}

void Governor::down(std::size_t level) noexcept {
  if (trying_) wait_[level_] = std::min(2.0 * wait_[level_], settings_.mostWait);
  trying_ = false;
  level_ = level;
  startAnew();
}

void Governor::up() noexcept {
  --level_;
  trying_ = true;
  tried_ = 0.0;
  startAnew();
}

std::size_t Governor::after(double step_us, double stepLength) noexcept {
  if (!(step_us >= 0.0) || !(stepLength >= 0.0)) return level_;
  note(step_us, stepLength);
  if (level_ + 1 < levels_) {
    const auto over = std::count_if(recent_.begin(), recent_.end(),
                                    [this](double time) { return time > budget_us_; });
    if (over >= static_cast<std::ptrdiff_t>(kOver)) {
      down(levelThatFits());
      return level_;
    }
    if (late_ > kLateInHand) {
      down(level_ + 1);
      return level_;
    }
  }
  if (level_ == 0) return level_;
  if (unfit_ > mayBeUnfit()) {
    calm_ = unfit_ = 0.0;
  } else if (calm_ >= wait_[level_ - 1]) {
    up();
  }
  return level_;
}

}  // namespace palpate
