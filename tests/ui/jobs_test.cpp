/// Work beside the window: the queue of jobs, and the child process that imports. No display.

#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "app/desktop_child.h"
#include "app/desktop_job.h"
#include "app/desktop_signals.h"

namespace palpate {
namespace {

using Lines = std::vector<std::pair<double, std::string>>;

Result<std::string> shell(const std::string& script, Lines* lines = nullptr,
                          const CancelToken* cancel = nullptr) {
  Progress progress;
  progress.cancel = cancel;
  progress.report = [lines](double f, const std::string& what) {
    if (lines != nullptr) lines->emplace_back(f, what);
  };
  return runChild("/bin/sh", {"-c", script}, progress);
}

TEST(Child, GivesItsOutputAndItsProgress) {
  Lines lines;
  const auto out = shell(
      "echo 'progress 0.25 Reading slice 1 of 4' >&2; echo noise >&2; echo 'progress 1 Done' >&2;"
      "echo '{\"a\": 1}'",
      &lines);
  ASSERT_TRUE(out) << sentence(out.error());
  EXPECT_EQ(*out, "{\"a\": 1}\n");
  const Lines expected{{0.25, "Reading slice 1 of 4"}, {1.0, "Done"}};
  EXPECT_EQ(lines, expected);
}

TEST(Child, AMegabyteOnBothPipesDoesNotBlockIt) {
  const auto out = shell(
      "head -c 1000000 /dev/zero | tr '\\\\0' x >&2; head -c 1000000 /dev/zero | tr '\\\\0' y");
  ASSERT_TRUE(out);
  EXPECT_EQ(out->size(), 1000000U);
}

TEST(Child, TheErrorItPrintedComesBackWhole) {
  const auto out = shell(
      R"(echo '{"error": {"kind": "input-refused", "message": "No scan.", "file": "x.dcm",
         "field": null, "found": "text", "expected": "DICOM", "advice": "Choose another."}}'; exit 3)");
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().kind, ErrorKind::InputRefused);
  EXPECT_EQ(sentence(out.error()),
            "No scan. File: x.dcm. Found: text. Expected: DICOM. Choose another.");
  EXPECT_FALSE(out.error().field);
}

TEST(Child, OneThatDiesSaysThatNothingWasChanged) {
  const auto out = shell("kill -SEGV $$");
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().message, "The import stopped unexpectedly while it read the scan.");
}

TEST(Child, AMissingProgramIsNamed) {
  const auto out = runChild("/no/such/program", {}, {});
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().kind, ErrorKind::Machine);
  EXPECT_EQ(out.error().file, "/no/such/program");
}

TEST(Child, CancelEndsItSoon) {
  CancelToken cancel;
  std::jthread later([&cancel] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    cancel.cancel();
  });
  const auto start = std::chrono::steady_clock::now();
  const auto out = shell("exec sleep 60", nullptr, &cancel);
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().kind, ErrorKind::Cancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Jobs, RunOneAfterTheOtherAndCompleteOnTheCallersThread) {
  JobQueue jobs;
  const auto caller = std::this_thread::get_id();
  std::vector<int> order;
  for (int i = 0; i < 3; ++i) {
    jobs.add("Job", [&, i](const Progress&) {
      EXPECT_NE(std::this_thread::get_id(), caller);
      return [&, i] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        order.push_back(i);
        if (i == 0) jobs.add("Later", [&](const Progress&) { return [&] { order.push_back(9); }; });
      };
    });
  }
  jobs.finishAll();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 9}));
  EXPECT_FALSE(jobs.busy());
  EXPECT_FALSE(jobs.model().active);
}

TEST(Jobs, ShowHowFarTheyAreAndStopWhenCancelled) {
  JobQueue jobs;
  bool cancelled = false;
  jobs.add("Counting", [&](const Progress& progress) {
    progress(0.4, "Two of five");
    while (!progress.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return [&] { cancelled = true; };
  });
  ui::JobModel model;
  model.fraction = -1.0;
  for (int i = 0; i < 5000 && model.fraction < 0.0; ++i) {
    model = jobs.model();
    if (model.fraction <= 0.0) model.fraction = -1.0;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(model.title, "Counting");
  EXPECT_EQ(model.what, "Two of five");
  EXPECT_DOUBLE_EQ(model.fraction, 0.4);
  jobs.cancel();
  EXPECT_FALSE(jobs.model().cancellable);
  jobs.finishAll();
  EXPECT_TRUE(cancelled);
}

TEST(Jobs, WhatIsDoneWhenIdleGivesWayToWhatIsWanted) {
  JobQueue jobs;
  std::vector<std::string> ended;
  jobs.addIdle("Measuring", [&](const Progress& progress) {
    while (!progress.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return [&] { ended.emplace_back("measuring cancelled"); };
  });
  jobs.addIdle("Measuring", [&](const Progress&) { return [&] { ended.emplace_back("again"); }; });
  jobs.add("Opening", [&](const Progress&) { return [&] { ended.emplace_back("opened"); }; });
  jobs.finishAll();
  EXPECT_EQ(ended, (std::vector<std::string>{"measuring cancelled", "opened"}));
}

TEST(Signals, ATerminationAsksTheWindowToCloseInsteadOfEndingTheProgram) {
  {
    const DesktopSignals signals;
    EXPECT_FALSE(DesktopSignals::askedToClose());
    ::raise(SIGTERM);
    EXPECT_TRUE(DesktopSignals::askedToClose());
  }
  struct sigaction now {};
  ::sigaction(SIGTERM, nullptr, &now);
  EXPECT_EQ(now.sa_handler, SIG_DFL) << "the old handler is back";
}

}  // namespace
}  // namespace palpate
