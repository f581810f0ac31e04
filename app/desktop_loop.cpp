#include "app/desktop_loop.h"

#include "app/desktop_signals.h"
#include "app/run_report.h"
#include "app/series_rows.h"
#include "core/base/whole_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t kTraceSamples = 140;
constexpr double kInformation_s = 7.0;  // long enough to read twice
constexpr double kIdle_s = 0.25;        // how long the window sleeps when nothing happens
constexpr double kFrame_s = 1.0 / 60.0;
constexpr double kSoftwareFrame_s = 1.0 / 30.0;  // leaves the cores to the servo
// In a picture run: servo ticks a frame, so that frame n always shows the same moment.
constexpr double kPictureStep_s = 0.016;

double monotonic() {
  return Seconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double norm(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

std::optional<ui::Task> taskNamed(const std::string& name) {
  if (name == "library") return ui::Task::Library;
  if (name == "segment") return ui::Task::Segment;
  if (name == "simulate") return ui::Task::Simulate;
  if (name == "review") return ui::Task::Review;
  return std::nullopt;
}

}  // namespace

Desktop::Desktop(const DesktopOptions& options) : options_(options), recent_(options.userFolder) {}

Result<std::unique_ptr<Desktop>> Desktop::open(const DesktopOptions& options) {
  std::unique_ptr<Desktop> self(new Desktop(options));
  ui::WindowOptions window;
  window.width = options.width;
  window.height = options.height;
  window.light = options.lightTheme;
  window.scale = options.uiScale;
  if (options.screenshot) {
    window.visible = false;
    if (window.scale <= 0.0F) window.scale = 1.0F;  // not the display's: always the same picture
  }
  if (!options.fonts.empty()) window.fonts = options.fonts;
  auto opened = ui::Window::open(window);
  if (!opened) return fail(opened.error());
  self->window_ = std::move(*opened);
  auto workspace = ui::Workspace::load(options.shaders);
  if (!workspace) return fail(workspace.error());
  self->workspace_ = std::move(*workspace);
  if (options.uiScript) {
    auto script = ui::UiScript::read(*options.uiScript);
    if (!script) return fail(script.error());
    self->script_ = std::move(*script);
  }
  std::error_code error;
  ui::Model& model = self->model_;
  model.library.demoAvailable = (options.demoCase && fs::exists(*options.demoCase, error)) ||
                                (options.demoScan && fs::exists(*options.demoScan, error));
  model.library.recent = self->recent_.list();
  model.task = taskNamed(options.task).value_or(ui::Task::Library);
  model.hideTimes = options.screenshot.has_value();
  const bool demo = options.demoHand || options.soak_s > 0.0;
  model.simulate.latch = demo;
  self->simulation_.setHand(demo || options.screenshot ? ui::HandKind::Demo : ui::HandKind::Mouse);
  self->startAfterPrepare_ = demo || options.screenshot.has_value();
  model.segment.exchange.folder = self->resolved("~");
  self->lookForDevices();
  self->readDatasets();
  self->openFirstCase();
  return self;
}

void Desktop::say(ui::MessageModel message) {
  constexpr std::size_t kMost = 3;
  if (model_.messages.size() >= kMost) model_.messages.erase(model_.messages.begin());
  if (message.kind == ui::MessageModel::Kind::Information) {
    message.until = monotonic() + kInformation_s;
  }
  model_.messages.push_back(std::move(message));
}

void Desktop::complain(const Error& error, const std::string& meaning) {
  if (error.kind == ErrorKind::Cancelled) return;
  ui::MessageModel message;
  message.kind = ui::MessageModel::Kind::Problem;
  message.happened = error.message;
  message.meaning = meaning;
  Error rest = error;
  rest.message.clear();
  if (rest.field && rest.field->rfind("--", 0) == 0) rest.field.reset();  // a command's option
  if (rest.advice) rest.advice = withoutCommandLine(*rest.advice);
  message.advice = sentence(rest);
  if (!message.advice.empty() && message.advice[0] == ' ') message.advice.erase(0, 1);
  say(std::move(message));
}

void Desktop::fillModel(double dt) {
  pollLabels();
  model_.job = jobs_.model();
  if (const ui::JobModel labels = labelWorker_.model(); labels.active) model_.job = labels;
  if (devices_.valid() && devices_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    const auto listed = devices_.get().devices;
    const bool named = std::any_of(listed.begin(), listed.end(), [](const ListedDevice& d) {
      return d.there && d.name.rfind("phantom:", 0) == 0;
    });
    for (const ListedDevice& device : listed) {
      const bool mouse = device.name == kSpaceMouse;
      if (!device.there || (device.info.simulated && !mouse)) continue;
      // "phantom" is whichever the vendor takes first: one of the named ones again.
      if (named && device.name == "phantom") continue;
      model_.simulate.devices.push_back(device.name);
      // What a 3D mouse moves is a simulated arm.
      hardware_.push_back(mouse ? std::nullopt : std::optional<DeviceInfo>(device.info));
    }
  }
  simulation_.describe(model_);
  model_.simulate.info = simulation_.info();
  review_.advance(dt);
  review_.describe(model_.review);
  std::erase_if(model_.messages, [](const auto& m) { return m.until < monotonic(); });
  const bool reviewing = model_.task == ui::Task::Review;
  // A recording's steps carry no times of this machine.
  model_.hideTimes = options_.screenshot.has_value() || reviewing || !simulation_.running();
  const Snapshot* run = simulation_.refresh();
  const Snapshot* replayed = reviewing ? review_.refresh() : nullptr;
  model_.snapshot = replayed != nullptr ? replayed : run;
  const bool moving = simulation_.running() || replayed != nullptr;
  if (moving && model_.snapshot != nullptr) {
    forceTrace_.push_back(static_cast<float>(norm(model_.snapshot->felt.force)));
    if (forceTrace_.size() > kTraceSamples) forceTrace_.pop_front();
  }
  model_.forceTrace.assign(forceTrace_.begin(), forceTrace_.end());
  workspace_->views().followTool = moving;
}

bool Desktop::mayClose() {
  if (closing_) return true;
  if (!window_->closing()) return false;
  if (!simulation_.recording()) return true;
  window_->keepOpen();
  model_.askClose = true;
  return false;
}

Result<bool> Desktop::scriptFrame(std::optional<fs::path>& screenshot) {
  if (!script_ || script_->finished()) return false;
  auto input = script_->next(workspace_->items(), !busy() && !workspace_->sending());
  if (!input) return fail(input.error());
  window_->inject(*input);
  if (input->phase) frameReport_.begin(*input->phase);
  screenshot = input->screenshot;
  return input->quit;
}

Result<void> Desktop::run() {
  const double frame = window_->softwareRendering() ? kSoftwareFrame_s : kFrame_s;
  double last = monotonic();
  int settle = 3;  // frames after an event: Dear ImGui answers an input a frame later
  bool quit = false;
  const DesktopSignals signals;
  while (!quit && !mayClose() && !DesktopSignals::askedToClose() && !soaked()) {
    std::optional<fs::path> screenshot;
    const auto asked = scriptFrame(screenshot);
    if (!asked) return fail(asked.error());
    quit = *asked;
    const bool awake = simulation_.running() || jobs_.busy() || labelWorker_.busy() ||
                       labelWorker_.previewing() || workspace_->busy() || settle > 0 ||
                       model_.review.playing || (script_ && !script_->finished());
    const double before = monotonic();
    window_->beginFrame(awake ? 0.0 : kIdle_s);
    const double now = monotonic();
    settle = !awake && now - before < kIdle_s * 0.98 ? 4 : std::max(0, settle - 1);
    if (jobs_.poll()) settle = 4;
    for (const fs::path& dropped : window_->dropped()) importScan(dropped);
    window_->clearDropped();
    fillModel(now - last);
    last = now;
    const double drawn = monotonic();
    const ui::Actions actions = workspace_->draw(*window_, model_, now, true);
    window_->endFrame();
    const double drawing = monotonic() - drawn;
    if (!actions.empty()) settle = 4;
    carryOut(actions);
    if (script_ && awake) frameReport_.add({monotonic() - before - drawing, drawing, busy()});
    if (screenshot) {
      if (auto written = ui::writePng(window_->picture(), *screenshot); !written) return written;
    }
    const double took = monotonic() - before;
    if (options_.soak_s > 0.0 && simulation_.running()) {
      frames_.add(static_cast<std::int64_t>(1e9 * took));
    }
    const double spare = frame - took;
    if (awake && spare > 0.0) std::this_thread::sleep_for(Seconds(spare));
  }
  Result<void> reported = options_.soak_s > 0.0 ? writeSoakReport() : Result<void>();
  if (reported && options_.frameReport) reported = frameReport_.write(*options_.frameReport);
  stopRun();
  saveBeforeClosing();
  return reported;
}

bool Desktop::soaked() const {
  if (options_.soak_s <= 0.0) return false;
  return refused_ || (model_.snapshot != nullptr && model_.snapshot->t >= options_.soak_s);
}

Result<void> Desktop::writeSoakReport() {
  const auto report = simulation_.report();
  if (!report || simulation_.scene() == nullptr) {
    return fail(usageError("The soak had nothing to run.")
                    .advise("Give a case with a label: --case CASE."));
  }
  nlohmann::ordered_json json = runReportJson(*report, *simulation_.scene());
  const Timing timing = frames_.timing();
  json["frames"] = frames_.count();
  json["frame_ms"] = {
      {"p50", timing.p50 / 1e3}, {"p99", timing.p99 / 1e3}, {"max", timing.max / 1e3}};
  return writeWholeFile(options_.soakReport, json.dump(1) + "\n");
}

Result<void> Desktop::renderPicture() {
  // One frame before the case is there: the camera wants to know the view's shape.
  window_->beginFrame(0.0);
  (void)workspace_->draw(*window_, model_, 0.0, true);
  window_->endFrame();
  finishWork();
  if (refused_) return fail(refusal_);
  constexpr int kDrawn = 3;  // frames after the last step: sizes of cards settle
  for (int i = 0; i < options_.frames + kDrawn; ++i) {
    simulation_.advanceVirtual(i < options_.frames ? kPictureStep_s : 0.0);
    const bool scripted = script_ && !script_->finished();
    fillModel(kPictureStep_s);
    if (i < options_.frames && !scripted) continue;
    std::optional<fs::path> ignored;
    if (const auto asked = scriptFrame(ignored); !asked) return fail(asked.error());
    window_->beginFrame(0.0);
    finishWork();
    const ui::Actions actions = workspace_->draw(*window_, model_, i * kPictureStep_s, false);
    window_->endFrame();
    carryOut(actions);
  }
  return ui::writePng(window_->picture(), *options_.screenshot);
}

bool Desktop::busy() const {
  return jobs_.busy() || labelWorker_.busy() || labelWorker_.previewing();
}

/// Pictures without a window loop: everything that was asked for is there.
void Desktop::finishWork() {
  do {
    jobs_.finishAll();
    labelWorker_.finish();
    pollLabels();
  } while (busy());
}

void Desktop::carryOut(const ui::Actions& actions) {
  for (const ui::Action& action : actions) carryOutOne(action);
}

namespace {

/// One lambda for each action.
template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};

}  // namespace

void Desktop::carryOutOne(const ui::Action& action) {
  using namespace ui;  // NOLINT(google-build-using-namespace): thirty names of one list
  std::visit(
      Overloaded{
          [this](const act::ShowTask& a) {
            if (model_.task == Task::Segment && a.task != Task::Segment) leaveSegment();
            model_.task = a.task;
            if (a.task == Task::Review) {
              const auto chosen = model_.review.chosen;
              refreshSessions();
              model_.review.chosen = chosen;
            }
          },
          [this](const act::OpenCase& a) { openCase(a.folder); },
          [this](const act::OpenDemo&) { openDemo(); },
          [this](const act::ForgetRecent& a) { recent_.forget(a.folder); },
          [this](const act::Browse& a) { browse(a.folder); },
          [this](const act::Import& a) { importScan(a.path); },
          [this](const act::ImportSeries& a) { importSeries(a.path, a.uid, ""); },
          [this](const act::CloseSeriesList&) { model_.library.series.clear(); },
          [this](const act::KeepNames& a) { model_.library.keepNames = a.yes; },
          [this](const act::CancelJob&) {
            if (labelWorker_.model().active) return labelWorker_.cancel();
            jobs_.cancel();
          },
          [this](const act::DismissMessage& a) {
            if (a.index >= model_.messages.size()) return;
            model_.messages.erase(model_.messages.begin() + static_cast<std::ptrdiff_t>(a.index));
          },
          [this](const act::PreviewStep& a) { labelWorker_.preview(a.step); },
          [this](const act::DropPreview&) { dropPreview(); },
          [this](const act::ApplyStep& a) { applyStepNow(a.step); },
          [this](const act::EditLabel& a) { editLabel(a); },
          [this](const act::ExportLabels& a) { exportLabelsNow(a.wish); },
          [this](const act::KeepFile&) { model_.segment.exchange.asks.reset(); },
          [this](const act::JoinLabels& a) { joinLabelsNow(a.file, a.only); },
          [this](const act::BrowseLabels& a) { browseLabels(a.folder); },
          [this](const act::TouchIt&) { touchIt(); },
          [this](const act::ShowLabel& a) {
            for (LabelRow& row : model_.segment.labels) {
              if (row.value == a.value) row.visible = a.visible;
            }
            workspace_->showRows(model_.segment.labels);
          },
          [this](const act::Undo&) { restore(Restoring::Undo); },
          [this](const act::Redo&) { restore(Restoring::Redo); },
          [this](const act::ChooseInstrument& a) {
            if (a.index >= instruments_.size() || jobs_.busy()) return;
            stopRun();
            sceneInstrument_ = instruments_[a.index].name;
            simulation_.setScene(nullptr);
            prepare();
          },
          [this](const act::ChooseDevice& a) { chooseDevice(a.index); },
          [this](const act::ImportRepaired& a) { importRepaired(a.yes); },
          [this](const act::MeasureTrade&) { measureTrade(); },
          [this](const act::ChooseTrade& a) { chooseTrade(a.name); },
          [this](const act::ChooseHand& a) { simulation_.setHand(a.hand); },
          [this](const act::Latch& a) {
            model_.simulate.latch = a.on;
            if (!a.on) simulation_.arm(false);
          },
          [this](const act::StartStop&) { startStop(); },
          [this](const act::Record&) { record(); },
          [this](const act::ResetTool&) {
            if (!simulation_.send({Command::Kind::ResetTool, 0.0})) {
              say({MessageModel::Kind::Warning, "The tool was not reset.",
                   "The simulation is behind.", "Press it again."});
            }
          },
          [this](const act::ForceOff&) { simulation_.forceOff(); },
          [this](const act::ClearFault&) { simulation_.clearFault(); },
          [this](const act::Arm& a) { simulation_.arm(a.on); },
          [this](const act::Grab& a) { model_.simulate.grabbed = a.on && simulation_.running(); },
          [this](const act::MoveHand& a) { simulation_.moveHand(a.delta_W); },
          [this](const act::TurnHand& a) { simulation_.turnHand(a.rotation_W); },
          [this](const act::SolverIterations& a) {
            (void)simulation_.send(
                {Command::Kind::SetSolverIterations, static_cast<double>(a.count)});
            model_.simulate.setting.solverIterations = a.count;
          },
          [this](const act::Coupling& a) {
            (void)simulation_.send({Command::Kind::SetCoupling, 0.01 * a.percent});
            model_.simulate.couplingPercent = a.percent;
          },
          [this](const act::ConfirmCalibration&) { simulation_.confirmCalibration(); },
          [this](const act::Reconnect&) { simulation_.reconnect(); },
          [this](const act::RefreshSessions&) { refreshSessions(); },
          [this](const act::ChooseSession& a) { chooseSession(a.index); },
          [this](const act::Replay&) { replay(); },
          [this](const act::PlayPause&) { review_.playPause(); },
          [this](const act::Scrub& a) { review_.scrub(a.at_s); },
          [this](const act::SwitchTheme&) { window_->setTheme(!window_->theme().light); },
          [this](const act::CloseAnyway&) {
            stopRun();
            model_.askClose = false;
            closing_ = true;
          },
          [this](const act::StayOpen&) { model_.askClose = false; },
      },
      action);
}

}  // namespace palpate
