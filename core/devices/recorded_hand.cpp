#include <algorithm>
#include <cmath>
#include <string>

#include "core/devices/hand.h"

namespace palpate {
namespace {

class RecordedHand final : public Hand {
 public:
  explicit RecordedHand(std::vector<RecordedPose> records) : records_(std::move(records)) {}

  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    if (t >= records_.back().t) return {records_.back().pose_D, 0, true};
    if (t <= records_.front().t) return {records_.front().pose_D, records_.front().buttons, true};
    if (t < records_[at_].t) at_ = 0;  // time went back: a new run
    while (records_[at_ + 1].t <= t) ++at_;
    const RecordedPose &a = records_[at_], &b = records_[at_ + 1];
    const double f = (t - a.t) / (b.t - a.t);
    const Eigen::Vector3d p = (1.0 - f) * position(a.pose_D) + f * position(b.pose_D);
    const Eigen::Quaterniond q = orientation(a.pose_D).slerp(f, orientation(b.pose_D));
    return {plain(p, q.normalized()), a.buttons, true};
  }

 private:
  std::vector<RecordedPose> records_;
  std::size_t at_ = 0;
};

}  // namespace

Result<std::unique_ptr<Hand>> makeRecordedHand(std::vector<RecordedPose> records) {
  if (records.empty()) {
    return fail(inputRefused("The recording holds no pose of the stylus.")
                    .advise("Choose a recording that was longer."));
  }
  for (std::size_t i = 0; i < records.size(); ++i) {
    const bool rises = i == 0 || records[i].t > records[i - 1].t;
    if (isRigid(records[i].pose_D) && std::isfinite(records[i].t) && rises) continue;
    return fail(inputRefused("The recording is not a motion: a pose or a time makes no sense.")
                    .inField("sample " + std::to_string(i))
                    .advise("Use a copy of the recording that is whole."));
  }
  return std::unique_ptr<Hand>(std::make_unique<RecordedHand>(std::move(records)));
}

}  // namespace palpate
