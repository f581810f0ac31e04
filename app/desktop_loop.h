#pragma once
/// The desktop itself: owns the window, the open case, the jobs and the simulation, and carries out
/// what the window asks for. Main thread.

#include <array>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "app/desktop.h"
#include "app/desktop_case.h"
#include "app/desktop_job.h"
#include "app/desktop_recent.h"
#include "app/desktop_review.h"
#include "app/desktop_simulation.h"
#include "app/frame_report.h"
#include "app/label_worker.h"
#include "app/trade_memo.h"
#include "core/devices/device_list.h"
#include "core/scene/material.h"
#include "core/simulation/histogram.h"
#include "imaging/segment/case_recipe.h"
#include "ui/workspace.h"

namespace palpate {

class Desktop {
 public:
  /// Opens the window and starts on the first case.
  [[nodiscard]] static Result<std::unique_ptr<Desktop>> open(const DesktopOptions& options);
  /// Until the window closes.
  [[nodiscard]] Result<void> run();
  /// A fixed number of frames, then the picture.
  [[nodiscard]] Result<void> renderPicture();

 private:
  explicit Desktop(const DesktopOptions& options);

  // desktop_loop.cpp: frames and actions
  void fillModel(double dt);
  void carryOut(const ui::Actions& actions);
  void carryOutOne(const ui::Action& action);
  [[nodiscard]] bool mayClose();
  [[nodiscard]] bool busy() const;
  void finishWork();
  /// True when the soak's time is over.
  [[nodiscard]] bool soaked() const;
  [[nodiscard]] Result<void> writeSoakReport();
  [[nodiscard]] Result<bool> scriptFrame(std::optional<std::filesystem::path>& screenshot);
  void say(ui::MessageModel message);
  void complain(const Error& error, const std::string& meaning = {});

  // desktop_import.cpp: the library
  void openFirstCase();
  void openCase(const std::filesystem::path& folder);
  void showCase(OpenCase open, CaseView view);
  void openDemo();
  void importScan(const std::filesystem::path& path);
  void importSeries(const std::filesystem::path& path, const std::string& uid,
                    const std::string& title);
  void importInto(const std::filesystem::path& path, const std::string& uid,
                  const std::filesystem::path& folder, bool demo, const std::string& repairs = {});
  void importRepaired(bool yes);
  void offerRepair(const Error& error, const std::filesystem::path& path, const std::string& uid);
  [[nodiscard]] std::filesystem::path newCaseFolder(const std::filesystem::path& scan) const;
  void browse(const std::filesystem::path& folder);

  // desktop_segment.cpp: labels and surfaces
  struct UndoEntry {
    std::shared_ptr<const PackedState> state;  ///< Null: only the table was another.
    LabelTable table;
    std::string what;
    CaseRecipe recipe;
  };
  enum class Restoring : std::uint8_t { No, Undo, Redo };
  void openLabels();
  void takeLabels(const SharedLabels& labels);
  void pollLabels();
  void takeOutcome(LabelWorker::Outcome& outcome);
  void takePreview(const LabelWorker::Outcome& outcome);
  void sayJoined(const LabelWorker::Outcome& outcome);
  void takeSurfaces(LabelWorker::Outcome& outcome);
  void dropPreview();
  void applyStepNow(const LabelStep& step);
  void editLabel(const ui::act::EditLabel& wish);
  void setTable(const LabelTable& table);
  void restore(Restoring which);
  void moveBetween(UndoEntry past);
  void saveLabels();
  void saveBeforeClosing();
  void meshLabels();
  void touchIt();
  void leaveSegment();
  void describeUndo();
  [[nodiscard]] int meshStep() const;
  [[nodiscard]] std::vector<ui::LabelRow> rowsOf(const CountedLabels& labels) const;

  // desktop_exchange.cpp: labels to files of other programs, and from them
  void exportLabelsNow(const ui::ExportWish& wish);
  void joinLabelsNow(const std::filesystem::path& file, const std::string& only);
  [[nodiscard]] std::filesystem::path resolved(const std::filesystem::path& typed) const;
  void browseLabels(const std::filesystem::path& folder);

  // desktop_scene.cpp: what is felt
  void readDatasets();
  void prepare();
  void takeScene(const std::shared_ptr<const PreparedScene>& scene);

  // desktop_trade.cpp: speed against accuracy
  void considerTrade(const std::string& key);
  void measureTrade();
  void takeTrade(const TradeMemo& memo);
  void chooseTrade(const std::string& name);
  void applyTrade(const std::string& name);
  void showTrade();
  void forgetTrade();

  // desktop_actions.cpp: simulation and review
  void startStop();
  void record();
  void replay();
  void chooseSession(std::size_t index);
  void refreshSessions();
  void stopRun();
  void lookForDevices();
  void chooseDevice(std::size_t index);

  DesktopOptions options_;
  std::unique_ptr<ui::Window> window_;        // outlives the workspace
  std::unique_ptr<ui::Workspace> workspace_;  // OpenGL objects
  ui::Model model_;
  RecentCases recent_;
  std::optional<OpenCase> open_;
  std::vector<UndoEntry> undo_, redo_;
  Restoring restoring_ = Restoring::No;
  std::deque<std::function<void()>> afterSteps_;  ///< Asked for while a step ran.
  CaseRecipe recipe_;
  std::map<std::uint8_t, ui::SharedChunks> surfaces_;  ///< Of the labels as they are.
  std::set<std::uint8_t> previewed_;                   ///< Whose drawn surface is a preview's.
  bool unsaved_ = false;
  std::vector<Instrument> instruments_;
  std::vector<Material> materials_;
  std::future<DeviceList> devices_;
  std::vector<std::optional<DeviceInfo>> hardware_;  ///< By device row: empty for simulated ones.
  DesktopSimulation simulation_;
  DesktopReview review_;
  std::optional<ui::UiScript> script_;
  std::deque<float> forceTrace_;
  std::string sceneInstrument_;
  SimulationSetting ownSetting_;  ///< Of the case's scene, whatever was chosen since.
  std::string tradeKey_;          ///< What trade_ holds for.
  std::optional<TradeMemo> trade_;
  std::string appliedTrade_ = "default";  ///< The row whose setting the scene has.
  Histogram frames_;                      ///< Of a soak: what a frame takes.
  FrameReport frameReport_;               ///< Of a script.
  bool startAfterPrepare_ = false, refused_ = false, closing_ = false;
  Error refusal_;
  LabelWorker labelWorker_;
  JobQueue jobs_;  // last: its thread ends before what it reads goes
};

}  // namespace palpate
