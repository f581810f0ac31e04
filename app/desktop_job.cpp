#include "app/desktop_job.h"

#include <chrono>
#include <utility>

namespace palpate {

JobQueue::~JobQueue() {
  waiting_.clear();
  if (running_) running_->cancel.cancel();
}

void JobQueue::add(std::string title, Work work, bool cancellable) {
  enqueue(std::move(title), std::move(work), cancellable, false);
}

void JobQueue::addIdle(std::string title, Work work) {
  enqueue(std::move(title), std::move(work), true, true);
}

void JobQueue::dropIdle() {
  std::erase_if(waiting_, [](const auto& job) { return job->idle; });
  if (running_ && running_->idle) running_->cancel.cancel();
}

void JobQueue::enqueue(std::string title, Work work, bool cancellable, bool idle) {
  dropIdle();
  auto job = std::make_unique<Job>();
  job->title = std::move(title);
  job->work = std::move(work);
  job->cancellable = cancellable;
  job->idle = idle;
  waiting_.push_back(std::move(job));
  if (!running_) startNext();
}

void JobQueue::addLatest(const std::string& title, Work work, bool cancellable) {
  std::erase_if(waiting_, [&title](const auto& job) { return job->title == title; });
  if (running_ && running_->title == title) running_->cancel.cancel();
  add(title, std::move(work), cancellable);
}

void JobQueue::startNext() {
  if (waiting_.empty()) return;
  running_ = std::move(waiting_.front());
  waiting_.pop_front();
  Job& job = *running_;
  job.started = std::chrono::steady_clock::now();
  job.thread = std::jthread([&job] {
    Progress progress;
    progress.cancel = &job.cancel;
    progress.report = [&job](double fraction, const std::string& what) {
      const std::lock_guard lock(job.mutex);
      job.fraction = fraction;
      job.what = what;
    };
    job.completion = job.work(progress);
    job.done.store(true, std::memory_order_release);
  });
}

bool JobQueue::poll() {
  if (!running_ || !running_->done.load(std::memory_order_acquire)) return false;
  const std::unique_ptr<Job> finished = std::move(running_);
  finished->thread.join();
  // The completion may add jobs of its own: they come after those that wait.
  if (finished->completion) finished->completion();
  if (!running_) startNext();
  return true;
}

void JobQueue::cancel() {
  if (running_ && running_->cancellable) running_->cancel.cancel();
}

void JobQueue::finishAll() {
  while (busy()) {
    if (!poll()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

ui::JobModel JobQueue::model() const {
  ui::JobModel model;
  if (!running_) return model;
  const std::lock_guard lock(running_->mutex);
  model.active = true;
  model.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - running_->started).count();
  model.title = running_->title;
  model.what = running_->cancel.cancelled() ? "Cancelling" : running_->what;
  model.fraction = running_->fraction;
  model.cancellable = running_->cancellable && !running_->cancel.cancelled();
  return model;
}

}  // namespace palpate
