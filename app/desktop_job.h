#pragma once
/// Long work beside the window: one job after the other on a thread, with progress and cancel.

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/progress.h"
#include "ui/model.h"

namespace palpate {

/// All calls on the main thread. The destructor cancels what runs and waits for it.
class JobQueue {
 public:
  /// Runs on the main thread when the work is done; starts no sooner than the next poll().
  using Completion = std::function<void()>;
  /// Runs on the job's thread.
  using Work = std::function<Completion(const Progress&)>;

  JobQueue() = default;
  ~JobQueue();
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  void add(std::string title, Work work, bool cancellable = true);
  /// As add(), but only while nothing else is wanted: any later job drops or cancels it.
  void addIdle(std::string title, Work work);
  void dropIdle();
  /// As add(); a job of the same title that waits is dropped, one that runs is cancelled.
  void addLatest(const std::string& title, Work work, bool cancellable = true);
  /// Takes a finished job's completion and starts the next. True if a completion ran.
  bool poll();
  /// The running job only; those that wait stay.
  void cancel();
  /// Polls until nothing is left (pictures without a window loop).
  void finishAll();
  [[nodiscard]] bool busy() const noexcept { return running_ != nullptr || !waiting_.empty(); }
  [[nodiscard]] ui::JobModel model() const;

 private:
  struct Job {
    std::string title;
    Work work;
    bool cancellable = true, idle = false;
    CancelToken cancel;
    Completion completion;
    std::chrono::steady_clock::time_point started;
    std::atomic<bool> done{false};
    mutable std::mutex mutex;  // of the two below
    double fraction = -1.0;
    std::string what;
    std::jthread thread;  // last: joins before the rest goes
  };
  void enqueue(std::string title, Work work, bool cancellable, bool idle);
  void startNext();
  std::unique_ptr<Job> running_;
  std::deque<std::unique_ptr<Job>> waiting_;
};

}  // namespace palpate
