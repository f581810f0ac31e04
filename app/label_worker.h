#pragma once
/// Segmentation beside the window: previews, of which the newest wins, and steps that stay.
///
/// All calls on the main thread; the work, the packing for undo and the surfaces of what changed
/// are made on a thread of its own. Every outcome comes through poll(), in order.

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "app/desktop_case.h"
#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/scene/anatomy.h"
#include "imaging/segment/apply.h"
#include "imaging/segment/packed_labels.h"
#include "ui/model.h"

namespace palpate {

/// Labels as they were, for undo and redo.
struct PackedState {
  PackedLabels labels;
  LabelTable table;
};

class LabelWorker {
 public:
  enum class Kind : std::uint8_t {
    Preview,   ///< Nothing changed; this is how it would be.
    Step,      ///< The labels are now these; `before` takes them back.
    Joined,    ///< As Step, with the labels of a file.
    Restored,  ///< The labels are again these; `before` as above.
    Surfaces   ///< Of what the outcome before this one changed.
  };
  struct Outcome {
    Kind kind = Kind::Preview;
    bool surfacesOfPreview = false;
    LabelStep step;
    Error error;  ///< Where `labels` is null.
    SharedLabels labels;
    std::uint64_t voxelsBefore = 0, voxelsAfter = 0;  ///< Of the step's label; previews only.
    std::shared_ptr<const PackedState> before;
    std::vector<LabelSurface> surfaces;
    std::vector<std::string> replaced, added, warnings;  ///< Of a file's labels.
  };

  LabelWorker();
  ~LabelWorker();  ///< Cancels and waits.
  LabelWorker(const LabelWorker&) = delete;
  LabelWorker& operator=(const LabelWorker&) = delete;

  /// A case; everything that runs for the last one is cancelled. `meshStep`: as meshLabel().
  void open(std::shared_ptr<const Volume> volume, SharedLabels labels, int meshStep);
  void close() { open(nullptr, nullptr, 1); }

  /// What new labels of known names look like and are made of. Before the first case.
  void setAnatomies(std::vector<Anatomy> anatomies) { anatomies_ = std::move(anatomies); }
  /// Replaces the preview that waits or runs.
  void preview(const LabelStep& step);
  void dropPreview();
  /// Runs after the steps before it. What was just previewed is not computed again; a surface that
  /// is being made of the step before is made with this one's.
  void commit(const LabelStep& step);
  /// Takes the labels of a file (imaging/exchange, joinLabels()), after the steps before it.
  void join(const std::filesystem::path& file, const std::string& only);
  void restore(std::shared_ptr<const PackedState> state);
  /// The table alone: names, colours, materials. Not while steps run (busy()); drops the preview.
  /// The labels with that table.
  [[nodiscard]] SharedLabels setTable(const LabelTable& table);
  /// The step that runs, and those that wait.
  void cancel();

  [[nodiscard]] std::optional<Outcome> poll();
  /// A step runs or waits (not a preview), or an outcome was not polled.
  [[nodiscard]] bool busy() const;
  /// A preview runs or waits.
  [[nodiscard]] bool previewing() const;
  /// Waits until nothing runs or waits; outcomes stay to be polled.
  void finish();
  /// Of the step that runs; not active for previews.
  [[nodiscard]] ui::JobModel model() const;

 private:
  struct Request {
    Kind kind = Kind::Preview;
    LabelStep step;
    std::shared_ptr<const PackedState> state;
    std::filesystem::path file;
    std::string only;
  };
  void work(const std::stop_token& stop);
  void carryOut(const Request& request, std::uint64_t generation);
  [[nodiscard]] Result<SharedLabels> labelsAfter(const Request& request, const Volume& volume,
                                                 const CountedLabels& before, Outcome& outcome);
  void makeSurfaces(const Request& request, const Volume& volume, const SharedLabels& before,
                    const SharedLabels& after, std::uint64_t generation);
  void deliver(Outcome outcome, std::uint64_t generation);
  /// Of a part of the running request.
  [[nodiscard]] Progress progress(double from = 0.0, double share = 1.0);
  /// What the window shows as running: a preview only where a step waits for it.
  [[nodiscard]] const Request* shown() const;

  mutable std::mutex mutex_;
  std::condition_variable_any wake_, idle_;
  std::deque<Request> waiting_;
  std::deque<Outcome> outcomes_;
  std::optional<Request> running_;
  std::shared_ptr<CancelToken> cancel_ = std::make_shared<CancelToken>();
  std::shared_ptr<const Volume> volume_;
  SharedLabels labels_;     ///< What steps start from.
  std::string previewKey_;  ///< Of the preview that `previewed_` is.
  SharedLabels previewed_;
  std::uint64_t generation_ = 0;  ///< Of the open case: late outcomes of another are dropped.
  std::vector<Anatomy> anatomies_;
  std::set<std::uint8_t> undrawn_;  ///< Changed by steps whose surfaces were left to the next.
  bool drawing_ = false;            ///< The running step is done; its surfaces are being made.
  int meshStep_ = 1;
  double fraction_ = -1.0;
  std::string what_;
  std::jthread thread_;  // last: joins before the rest goes
};

/// Values that differ anywhere between two states, or are in one table only.
[[nodiscard]] std::vector<std::uint8_t> changedLabels(const CountedLabels& a,
                                                      const CountedLabels& b);

}  // namespace palpate
