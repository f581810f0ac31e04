#include "app/desktop_review.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "core/geometry/units.h"
#include "ui/format.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
constexpr const char* kExtension = ".session";
constexpr std::size_t kRows = 4000;  // steps kept for the graph and for scrubbing

double norm(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

}  // namespace

std::vector<ui::SessionRow> listSessions(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    // A crash leaves FILE.part, which replays too.
    const fs::path& path = entry.path();
    if (path.extension() == kExtension ||
        (path.extension() == ".part" && path.stem().extension() == kExtension)) {
      files.push_back(path);
    }
  }
  std::sort(files.rbegin(), files.rend());
  std::vector<ui::SessionRow> rows;
  for (const fs::path& file : files) {
    const auto header = readSessionHeader(file);
    if (!header) continue;
    ui::SessionRow row;
    row.file = file;
    row.title = file.stem().string();
    std::replace(row.title.begin(), row.title.end(), '_', ' ');
    const double seconds = static_cast<double>(header->ticks) * 1e-3;
    row.detail = ui::clockText(seconds) + " \xc2\xb7 " + header->scene.instrument + " \xc2\xb7 " +
                 header->deviceName;
    if (!header->finished) row.detail = "Ended early \xc2\xb7 " + row.detail;
    row.exact = header->exact;
    row.finished = header->finished;
    rows.push_back(row);
  }
  return rows;
}

fs::path newSessionFile(const fs::path& caseFolder) {
  const fs::path folder = caseFolder / "sessions";
  std::error_code error;
  fs::create_directories(folder, error);
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  char name[64];
  std::strftime(name, sizeof name, "%Y-%m-%d_%H-%M-%S", &local);
  fs::path file = folder / (std::string(name) + kExtension);
  for (int i = 2; fs::exists(file, error); ++i) {
    file = folder / (std::string(name) + "_" + std::to_string(i) + kExtension);
  }
  return file;
}

Result<LoadedSession> loadSession(const fs::path& file) {
  LoadedSession session;
  session.file = file;
  auto header = readSessionHeader(file);
  if (!header) return fail(header.error());
  session.header = std::move(*header);
  const std::uint64_t stride = std::max<std::uint64_t>(1, session.header.steps / kRows);
  auto steps = readSteps(file, stride);
  if (!steps) return fail(steps.error());
  session.steps = std::move(*steps);
  session.stepPeriod = session.header.scene.setting.stepPeriod;
  return session;
}

void DesktopReview::setSession(LoadedSession session) {
  clear();
  for (const StepRecord& step : session.steps) {
    time_s_.push_back(static_cast<float>(static_cast<double>(step.step) * session.stepPeriod));
    force_N_.push_back(static_cast<float>(norm(step.contact.force)));
    depth_mm_.push_back(static_cast<float>(millimetres(step.depth)));
  }
  session_ = std::move(session);
  scrub(0.0);
}

void DesktopReview::clear() {
  session_.reset();
  time_s_.clear();
  force_N_.clear();
  depth_mm_.clear();
  playing_ = false;
  verdict_ = ui::ReviewModel::Verdict::None;
}

void DesktopReview::scrub(double at_s) {
  if (!session_ || session_->steps.empty()) return;
  const double end = static_cast<double>(time_s_.back());
  at_s_ = std::clamp(at_s, 0.0, end);
  const auto found = std::lower_bound(time_s_.begin(), time_s_.end(), static_cast<float>(at_s_));
  const auto index =
      std::min(session_->steps.size() - 1, static_cast<std::size_t>(found - time_s_.begin()));
  const StepRecord& step = session_->steps[index];
  shown_ = Snapshot{};
  shown_.step = step.step;
  shown_.t = at_s_;
  shown_.tool = shown_.device = step.tool;
  shown_.contact = shown_.felt = step.contact;
  shown_.contacts = step.contacts;
  shown_.depth = step.depth;
}

void DesktopReview::advance(double dt) {
  if (!playing_ || !session_ || time_s_.empty()) return;
  const double next = at_s_ + dt;
  if (next >= static_cast<double>(time_s_.back())) playing_ = false;
  scrub(next);
}

void DesktopReview::setVerdict(const Result<ReplayReport>& report) {
  if (!report) return;
  const std::string steps = ui::grouped(report->steps);
  if (report->identical) {
    verdict_ = ui::ReviewModel::Verdict::Identical;
    verdictText_ = "Identical: all " + steps + " steps gave the recorded states, bit for bit.";
    return;
  }
  verdict_ = ui::ReviewModel::Verdict::Different;
  verdictText_ = "Different";
  if (report->firstDifference) {
    verdictText_ += " from step " + ui::grouped(report->firstDifference->step) + " of " + steps;
  }
  verdictText_ +=
      ". The session was made by another build, or it dropped samples; its numbers "
      "still stand, but they cannot be recomputed exactly here.";
}

const Snapshot* DesktopReview::refresh() {
  if (replaying_) {
    if (live_.refresh()) shown_ = live_.value();
    return &shown_;
  }
  return session_ ? &shown_ : nullptr;
}

void DesktopReview::describe(ui::ReviewModel& model) const {
  model.time_s = time_s_;
  model.force_N = force_N_;
  model.depth_mm = depth_mm_;
  model.duration_s = time_s_.empty() ? 0.0 : static_cast<double>(time_s_.back());
  model.at_s = at_s_;
  model.playing = playing_;
  model.verdict = verdict_;
  model.verdictText = verdictText_;
}

}  // namespace palpate
