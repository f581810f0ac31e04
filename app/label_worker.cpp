#include "app/label_worker.h"

#include <algorithm>
#include <array>
#include <utility>

#include "imaging/exchange/label_exchange.h"
#include "imaging/segment/recipe.h"

namespace palpate {
namespace {

constexpr double kWork = 0.9;  // of the progress; the rest is keeping the labels for undo

std::uint64_t voxelsOf(const CountedLabels& labels, const std::string& label) {
  const auto row = std::find_if(labels.table.begin(), labels.table.end(),
                                [&label](const LabelInfo& l) { return l.name == label; });
  return row == labels.table.end() ? 0 : labels.voxels[row->value];
}

}  // namespace

LabelWorker::LabelWorker() {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

LabelWorker::~LabelWorker() {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    cancel_->cancel();
  }
  thread_.request_stop();
  wake_.notify_all();
}

void LabelWorker::open(std::shared_ptr<const Volume> volume, SharedLabels labels, int meshStep) {
  const std::lock_guard lock(mutex_);
  ++generation_;
  cancel_->cancel();
  waiting_.clear();
  outcomes_.clear();
  volume_ = std::move(volume);
  labels_ = labels ? std::move(labels) : countedLabels({});
  previewed_.reset();
  meshStep_ = meshStep;
}

void LabelWorker::dropPreview() {
  const std::lock_guard lock(mutex_);
  std::erase_if(waiting_, [](const Request& r) { return r.kind == Kind::Preview; });
  std::erase_if(outcomes_, [](const Outcome& o) {
    return o.kind == Kind::Preview || (o.kind == Kind::Surfaces && o.surfacesOfPreview);
  });
  if (running_ && running_->kind == Kind::Preview) cancel_->cancel();
  previewed_.reset();
}

void LabelWorker::preview(const LabelStep& step) {
  dropPreview();
  const std::lock_guard lock(mutex_);
  if (!volume_) return;
  waiting_.push_back({Kind::Preview, step, {}, {}, {}});
  wake_.notify_all();
}

void LabelWorker::commit(const LabelStep& step) {
  const std::lock_guard lock(mutex_);
  if (!volume_) return;
  std::erase_if(waiting_, [](const Request& r) { return r.kind == Kind::Preview; });
  const std::string key = recipeText({step});
  if (running_ && running_->kind == Kind::Preview) {
    const bool same = recipeText({running_->step}) == key;
    const bool made = previewed_ && previewKey_ == key;  // only its surface is missing
    if (!same || made) cancel_->cancel();
  }
  if (drawing_) cancel_->cancel();  // of labels that are soon out of date
  waiting_.push_back({Kind::Step, step, {}, {}, {}});
  wake_.notify_all();
}

void LabelWorker::join(const std::filesystem::path& file, const std::string& only) {
  dropPreview();
  const std::lock_guard lock(mutex_);
  if (!volume_) return;
  if (drawing_) cancel_->cancel();
  waiting_.push_back({Kind::Joined, {}, {}, file, only});
  wake_.notify_all();
}

void LabelWorker::restore(std::shared_ptr<const PackedState> state) {
  dropPreview();
  const std::lock_guard lock(mutex_);
  if (!volume_ || !state) return;
  if (drawing_) cancel_->cancel();
  waiting_.push_back({Kind::Restored, {}, std::move(state), {}, {}});
  wake_.notify_all();
}

SharedLabels LabelWorker::setTable(const LabelTable& table) {
  dropPreview();
  const std::lock_guard lock(mutex_);
  auto changed = std::make_shared<CountedLabels>(*labels_);  // the voxels are shared
  changed->table = table;
  labels_ = std::move(changed);
  return labels_;
}

void LabelWorker::cancel() {
  const std::lock_guard lock(mutex_);
  waiting_.clear();
  if (!drawing_) cancel_->cancel();  // a step that is done is drawn
}

std::optional<LabelWorker::Outcome> LabelWorker::poll() {
  const std::lock_guard lock(mutex_);
  if (outcomes_.empty()) return std::nullopt;
  Outcome outcome = std::move(outcomes_.front());
  outcomes_.pop_front();
  return outcome;
}

bool LabelWorker::busy() const {
  const std::lock_guard lock(mutex_);
  const auto stays = [](const Request& r) { return r.kind != Kind::Preview; };
  return (running_ && stays(*running_)) || std::any_of(waiting_.begin(), waiting_.end(), stays) ||
         !outcomes_.empty();
}

bool LabelWorker::previewing() const {
  const std::lock_guard lock(mutex_);
  const auto passes = [](const Request& r) { return r.kind == Kind::Preview; };
  return (running_ && passes(*running_)) || std::any_of(waiting_.begin(), waiting_.end(), passes);
}

void LabelWorker::finish() {
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [this] { return !running_ && waiting_.empty(); });
}

const LabelWorker::Request* LabelWorker::shown() const {
  if (running_ && running_->kind != Kind::Preview) return &*running_;
  const auto step = std::find_if(waiting_.begin(), waiting_.end(),
                                 [](const Request& r) { return r.kind != Kind::Preview; });
  return step == waiting_.end() ? nullptr : &*step;
}

ui::JobModel LabelWorker::model() const {
  const std::lock_guard lock(mutex_);
  ui::JobModel model;
  const Request* request = shown();
  if (request == nullptr) return model;
  model.active = true;
  model.title = request->kind == Kind::Restored ? "Restoring the labels"
                : request->kind == Kind::Joined ? "Taking the labels of the file"
                                                : toolTitle(request->step.tool);
  if (drawing_) model.title = "Drawing the surface";
  model.what = cancel_->cancelled() ? "Cancelling" : what_;
  model.fraction = fraction_;
  model.cancellable = !drawing_ && !cancel_->cancelled();
  return model;
}

Progress LabelWorker::progress(double from, double share) {
  Progress progress;
  progress.cancel = cancel_.get();
  progress.report = [this, from, share](double fraction, const std::string& what) {
    const std::lock_guard lock(mutex_);
    fraction_ = from + share * fraction;
    what_ = what;
  };
  return progress;
}

void LabelWorker::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    Request request;
    std::uint64_t generation = 0;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, stop, [this] { return !waiting_.empty(); });
      if (stop.stop_requested()) return;
      request = std::move(waiting_.front());
      waiting_.pop_front();
      running_ = request;
      cancel_ = std::make_shared<CancelToken>();
      drawing_ = false;
      fraction_ = -1.0;
      what_.clear();
      generation = generation_;
    }
    carryOut(request, generation);
    const std::lock_guard lock(mutex_);
    running_.reset();
    idle_.notify_all();
  }
}

void LabelWorker::deliver(Outcome outcome, std::uint64_t generation) {
  const std::lock_guard lock(mutex_);
  if (generation != generation_) return;
  const bool stale = outcome.kind == Kind::Preview && cancel_->cancelled();
  if (!stale) outcomes_.push_back(std::move(outcome));
}

Result<SharedLabels> LabelWorker::labelsAfter(const Request& request, const Volume& volume,
                                              const CountedLabels& before, Outcome& outcome) {
  if (request.kind == Kind::Joined) {
    auto joined =
        joinLabels(request.file, volume.geometry, request.only, {*before.grid, before.table},
                   rowsOfAnatomies(anatomies_), progress(0.0, kWork));
    if (!joined) return fail(joined.error());
    outcome.replaced = std::move(joined->replaced);
    outcome.added = std::move(joined->added);
    outcome.warnings = std::move(joined->warnings);
    return countedLabels(std::move(joined->state));
  }
  if (request.kind == Kind::Restored) {
    auto labels = request.state->labels.unpack(progress(0.0, kWork));
    if (!labels) return fail(labels.error());
    return countedLabels({std::move(*labels), request.state->table});
  }
  {
    const std::lock_guard lock(mutex_);
    if (previewed_ && previewKey_ == recipeText({request.step})) return previewed_;
  }
  auto after = applyStep(volume, *before.grid, before.table, request.step, progress(0.0, kWork));
  if (!after) return fail(after.error());
  dressNewRows(before.table, after->table, anatomies_);
  return countedLabels(std::move(*after));
}

void LabelWorker::carryOut(const Request& request, std::uint64_t generation) {
  SharedLabels before;
  std::shared_ptr<const Volume> volume;
  {
    const std::lock_guard lock(mutex_);
    if (generation != generation_) return;
    before = labels_;
    volume = volume_;
  }
  Outcome outcome;
  outcome.kind = request.kind;
  outcome.step = request.step;
  auto after = labelsAfter(request, *volume, *before, outcome);
  if (after && request.kind != Kind::Preview) {
    auto packed = PackedLabels::pack(*before->grid, progress(kWork, 1.0 - kWork));
    if (packed) {
      outcome.before =
          std::make_shared<const PackedState>(PackedState{std::move(*packed), before->table});
    } else {
      after = fail(packed.error());
    }
  }
  if (!after) {
    outcome.error = after.error();
    deliver(std::move(outcome), generation);
    if (request.kind != Kind::Preview) makeSurfaces(request, *volume, before, before, generation);
    return;
  }
  outcome.labels = *after;
  if (request.kind == Kind::Preview) {
    outcome.voxelsBefore = voxelsOf(*before, request.step.label);
    outcome.voxelsAfter = voxelsOf(**after, request.step.label);
  }
  {
    const std::lock_guard lock(mutex_);
    if (generation != generation_) return;
    if (request.kind == Kind::Preview) {
      if (cancel_->cancelled()) return;  // dropped: of labels that may be others by now
      previewed_ = *after;
      previewKey_ = recipeText({request.step});
    } else {
      labels_ = *after;
      previewed_.reset();
    }
  }
  deliver(std::move(outcome), generation);
  makeSurfaces(request, *volume, before, *after, generation);
}

void LabelWorker::makeSurfaces(const Request& request, const Volume& volume,
                               const SharedLabels& before, const SharedLabels& after,
                               std::uint64_t generation) {
  const bool stays = request.kind != Kind::Preview;
  std::set<std::uint8_t> values = stays ? std::exchange(undrawn_, {}) : std::set<std::uint8_t>{};
  for (const std::uint8_t value : changedLabels(*before, *after)) values.insert(value);
  int meshStep = 1;
  {
    const std::lock_guard lock(mutex_);
    meshStep = meshStep_;  // open() may set it for another case meanwhile
    const bool another = std::any_of(waiting_.begin(), waiting_.end(),
                                     [](const Request& r) { return r.kind != Kind::Preview; });
    if (stays && another) {  // its surfaces are soon out of date: the next step draws them too
      undrawn_ = std::move(values);
      return;
    }
    drawing_ = stays;
  }
  LabelTable changed;
  for (const LabelInfo& row : after->table) {
    if (values.contains(row.value)) changed.push_back(row);
  }
  if (changed.empty() && !stays) return;
  auto surfaces = surfacesOf(*after->grid, changed, volume, meshStep, progress());
  if (!surfaces) {  // cancelled: the next preview brings its own, the next step draws these too
    const std::lock_guard lock(mutex_);
    drawing_ = false;
    if (stays) undrawn_ = std::move(values);
    return;
  }
  Outcome outcome;
  outcome.kind = Kind::Surfaces;
  outcome.surfacesOfPreview = request.kind == Kind::Preview;
  outcome.labels = after;
  outcome.surfaces = std::move(*surfaces);
  const std::lock_guard lock(mutex_);
  drawing_ = false;
  if (generation != generation_) return;
  if (outcome.surfacesOfPreview && cancel_->cancelled()) return;
  outcomes_.push_back(std::move(outcome));
}

std::vector<std::uint8_t> changedLabels(const CountedLabels& a, const CountedLabels& b) {
  std::array<bool, 256> changed{};
  const std::vector<std::uint8_t>&x = a.grid->labels, &y = b.grid->labels;
  for (std::size_t i = 0; a.grid != b.grid && i < std::max(x.size(), y.size()); ++i) {
    const std::uint8_t before = i < x.size() ? x[i] : std::uint8_t{0};
    const std::uint8_t after = i < y.size() ? y[i] : std::uint8_t{0};
    if (before != after) changed[before] = changed[after] = true;
  }
  std::vector<std::uint8_t> out;
  for (std::size_t value = 1; value < changed.size(); ++value) {
    const auto in = [value](const LabelTable& table) {
      return std::any_of(table.begin(), table.end(),
                         [value](const LabelInfo& l) { return l.value == value; });
    };
    if (changed[value] || in(a.table) != in(b.table))
      out.push_back(static_cast<std::uint8_t>(value));
  }
  return out;
}

}  // namespace palpate
