#include "core/session/recorder.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <mutex>
#include <thread>

#include "core/base/whole_file.h"
#include "core/session/session_file.h"
#include "core/session/session_writer.h"
#include "core/simulation/bounded_queue.h"

#ifndef PALPATE_VERSION
#error "core/session/CMakeLists.txt defines the program's version"
#endif

namespace palpate {
namespace {

using namespace std::chrono_literals;

// Eight seconds of samples: longer than any disk's hiccup that a recording should survive.
constexpr std::size_t kQueueCapacity = 8192;
constexpr std::size_t kCommandCapacity = 1024;
constexpr auto kDrainPeriod = 20ms;
// interface.md: a crash loses at most the last second; half of it leaves room for a slow disk.
constexpr auto kCommitPeriod = 500ms;

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
  return text;
}

void removeDatabase(const std::filesystem::path& file) {
  for (const char* tail : {"", "-wal", "-shm", "-journal"}) {
    ::unlink((file.string() + tail).c_str());
  }
}

class FileRecorder final : public Recorder {
 public:
  FileRecorder(std::filesystem::path file, std::unique_ptr<SessionWriter> writer,
               const std::vector<GovernorLevel>& levels, bool waits)
      : file_(std::move(file)), part_(partOf(file_)), waits_(waits), writer_(std::move(writer)) {
    for (const GovernorLevel& level : levels) levelNames_.push_back(level.name);
    thread_ = std::thread([this] { work(); });
  }
  FileRecorder(const FileRecorder&) = delete;
  FileRecorder& operator=(const FileRecorder&) = delete;
  ~FileRecorder() override {
    stopThread();
    if (!finished_) {
      writer_->close();
      removeDatabase(part_);
    }
  }

  static std::filesystem::path partOf(const std::filesystem::path& file) {
    return file.string() + ".part";
  }

  bool onTick(const ServoSample& sample) noexcept override { return push(samples_, sample); }
  bool onStep(const StepRecord& step) noexcept override { return push(steps_, step); }
  bool onCommand(std::uint64_t step, const Command& command) noexcept override {
    return push(commands_, TimedCommand{step, command});
  }
  [[nodiscard]] std::uint64_t drops() const noexcept override {
    return drops_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] Result<void> finish(const RunReport& report) override;

 private:
  template <class T>
  bool push(BoundedQueue<T>& queue, const T& item) noexcept;
  void work();
  void drain();
  void stopThread();

  std::filesystem::path file_, part_;
  std::vector<std::string> levelNames_;
  bool waits_;  ///< Virtual clock: there is no deadline, so waiting beats dropping.
  BoundedQueue<ServoSample> samples_{kQueueCapacity};
  BoundedQueue<StepRecord> steps_{kQueueCapacity};
  BoundedQueue<TimedCommand> commands_{kCommandCapacity};
  std::atomic<std::uint64_t> drops_{0};
  std::atomic<bool> closed_{false};  ///< Finished, or the file failed: takes nothing more.
  std::unique_ptr<SessionWriter> writer_;
  bool toldInexact_ = false;
  bool finished_ = false;
  std::mutex stopMutex_;  ///< Between the recorder's thread and finish(); no loop takes it.
  std::condition_variable stopSignal_;
  bool stop_ = false;
  std::thread thread_;
};

template <class T>
bool FileRecorder::push(BoundedQueue<T>& queue, const T& item) noexcept {
  while (!closed_.load(std::memory_order_acquire)) {
    if (queue.tryPush(item)) return true;
    if (!waits_) break;
    const timespec pause{0, 200000};
    ::nanosleep(&pause, nullptr);
  }
  drops_.fetch_add(1, std::memory_order_relaxed);
  return false;
}

// Steps before commands before samples: whatever a step refers to was queued before it, so no
// transaction holds a step without its sample.
void FileRecorder::drain() {
  StepRecord step;
  while (steps_.tryPop(step)) writer_->step(step);
  TimedCommand command;
  while (commands_.tryPop(command)) writer_->command(command);
  ServoSample sample;
  while (samples_.tryPop(sample)) writer_->sample(sample);
  writer_->levelEvents(levelNames_);
  if (drops() > 0 && !toldInexact_) {
    writer_->meta("exact", "0");
    toldInexact_ = true;
  }
  if (writer_->error()) closed_.store(true, std::memory_order_release);
}

void FileRecorder::work() {
  writer_->begin();
  auto committed = std::chrono::steady_clock::now();
  std::unique_lock<std::mutex> lock(stopMutex_);
  while (!stopSignal_.wait_for(lock, kDrainPeriod, [this] { return stop_; })) {
    lock.unlock();
    drain();
    const auto now = std::chrono::steady_clock::now();
    if (now - committed >= kCommitPeriod) {
      writer_->commit();
      writer_->begin();
      committed = now;
    }
    lock.lock();
  }
  closed_.store(true, std::memory_order_release);
  drain();
  writer_->commit();
}

void FileRecorder::stopThread() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(stopMutex_);
    stop_ = true;
  }
  stopSignal_.notify_all();
  thread_.join();
}

Result<void> FileRecorder::finish(const RunReport& report) {
  if (finished_) return {};
  stopThread();
  finished_ = true;
  Packer packer;
  pack(packer, report);
  writer_->begin();
  writer_->part("report", packer.bytes());
  writer_->meta("exact", drops() == 0 && report.recorderDrops == 0 ? "1" : "0");
  writer_->meta("finished", "1");
  writer_->commit();
  writer_->close();
  auto fails = [this](Error error) {
    removeDatabase(part_);
    return fail(std::move(error));
  };
  if (writer_->error()) return fails(*writer_->error());
  if (auto flushed = flushToDisk(part_); !flushed) return fails(flushed.error());
  if (::rename(part_.c_str(), file_.c_str()) != 0) return fails(cannotWrite(file_, errno));
  const auto folder = file_.parent_path();
  return flushToDisk(folder.empty() ? "." : folder);
}

void writeHead(SessionWriter& writer, const PreparedScene& scene, const DeviceInfo& device,
               const RunOptions& options) {
  writer.begin();
  writer.meta("program_version", PALPATE_VERSION);
  writer.meta("device", device.name);
  writer.meta("seed", std::to_string(options.seed));
  writer.meta("clock", options.clock == Clock::Virtual ? "virtual" : "real");
  writer.meta("fingerprint", hex(scene.fingerprint));
  writer.meta("exact", "1");
  writer.meta("finished", "0");
  for (const auto& [name, data] : partsOf(scene)) writer.part(name, data);
  Packer gains;
  pack(gains, recommendedGains(device, scene.scene.setting.stepPeriod));  // as the runner has them
  writer.part("gains", gains.bytes());
  writer.commit();
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::create(const std::filesystem::path& file,
                                                   const PreparedScene& scene,
                                                   const DeviceInfo& device,
                                                   const RunOptions& options, bool overwrite) {
  std::error_code code;
  if (std::filesystem::is_directory(file, code)) {
    return fail(inputRefused("A session is a file, and a folder has that name.")
                    .inFile(file.string())
                    .advise("Choose another name."));
  }
  if (std::filesystem::exists(file, code) && !overwrite) {
    return fail(inputRefused("The file exists already.")
                    .inFile(file.string())
                    .advise("Choose another name, or move the file away."));
  }
  if (auto writable = checkWritable(file); !writable) return fail(writable.error());
  const auto part = FileRecorder::partOf(file);
  removeDatabase(part);  // of a recording that was cut off; its name is taken anew
  // Made first, so that it is the user's alone: it holds a patient's anatomy. The log follows it.
  const int handle = ::open(part.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  if (handle < 0) return fail(cannotWrite(file, errno));
  ::close(handle);
  auto writer = SessionWriter::create(part, file);
  if (!writer) {
    removeDatabase(part);
    return fail(writer.error());
  }
  writeHead(**writer, scene, device, options);
  if ((*writer)->error()) {
    const Error error = *(*writer)->error();
    (*writer)->close();
    removeDatabase(part);
    return fail(error);
  }
  return std::unique_ptr<Recorder>(std::make_unique<FileRecorder>(
      file, std::move(*writer), scene.levels, options.clock == Clock::Virtual));
}

}  // namespace palpate
