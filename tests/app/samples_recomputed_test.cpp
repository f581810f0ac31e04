// What `simulate --samples` writes, recomputed by a script that knows nothing but the file: energy,
// slew, peak and continuous force. And files that are spoiled, which it must refuse.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <functional>
#include <sstream>

#include "tests/app/ball_suite.h"

namespace palpate::test {
namespace {

constexpr std::size_t kForceX = 11;  // column of fx_N

using Row = std::vector<std::string>;

std::vector<Row> rowsOf(const std::filesystem::path& file) {
  std::vector<Row> rows;
  std::istringstream lines(contentOf(file));
  for (std::string line; std::getline(lines, line);) {
    Row row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    rows.push_back(row);
  }
  return rows;
}

void write(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + row[i];
    text += '\n';
  }
  writeText(file, text);
}

void setForce(Row& row, double x, double y, double z) {
  row[kForceX] = std::to_string(x);
  row[kForceX + 1] = std::to_string(y);
  row[kForceX + 2] = std::to_string(z);
}

double number(const Row& row, std::size_t column) {
  return std::stod(row[column]);
}

class SamplesRecomputed : public BallSuite {
 protected:
  void SetUp() override {
    if (std::string(PALPATE_PYTHON).empty()) GTEST_SKIP() << "There is no Python 3.";
    ASSERT_TRUE(made);
  }
  static std::filesystem::path simulated(const std::string& device) {
    const auto file = *folder / (device + ".csv");
    if (!std::filesystem::exists(file)) {
      const ProgramRun run = palpate({"simulate", *folder / "case", "--seconds", "6", "--seed", "3",
                                      "--device", device, "--samples", file});
      EXPECT_EQ(run.exitCode, 0) << run.err;
    }
    return file;
  }
  /// The script's exit code; what it says in `said`.
  static int recompute(const std::filesystem::path& file, const std::string& device,
                       std::string& said) {
    const auto out = *folder / "said";
    const std::string command = std::string("'") + PALPATE_PYTHON + "' -B '" + PALPATE_TEST_FILES +
                                "/stability/recompute_samples.py' '" + file.string() +
                                "' --device " + device + " > '" + out.string() + "' 2>&1";
    const int status = std::system(command.c_str());
    said = contentOf(out);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// A run of the Touch X with something done to its rows (the first is the heading).
  static void expectBroken(const std::string& promise,
                           const std::function<void(std::vector<Row>&)>& spoil) {
    std::vector<Row> rows = rowsOf(simulated("touch-x"));
    ASSERT_EQ(rows.size(), 6001U);
    spoil(rows);
    write(*folder / "spoiled.csv", rows);
    std::string said;
    EXPECT_EQ(recompute(*folder / "spoiled.csv", "touch-x", said), 1);
    bool told = false;
    std::istringstream lines(said);
    for (std::string line; std::getline(lines, line);) {
      told = told || (line.starts_with(promise) && line.ends_with("BROKEN"));
    }
    EXPECT_TRUE(told) << promise << " not in:\n" << said;
  }
};

TEST_F(SamplesRecomputed, EveryDeviceKeepsItsPromises) {
  for (const std::string device : {"touch", "touch-x", "premium-6dof"}) {
    std::string said;
    EXPECT_EQ(recompute(simulated(device), device, said), 0) << device << "\n" << said;
    double most = 0.0;
    const std::vector<Row> rows = rowsOf(simulated(device));
    for (std::size_t i = 1; i < rows.size(); ++i) {
      most = std::max(most, std::abs(number(rows[i], kForceX)));
    }
    EXPECT_GT(most, 0.2) << device << ": nothing was felt";
  }
}

TEST_F(SamplesRecomputed, AForceTurnedRoundIsFound) {
  // What pressed against the hand now pulls it along.
  expectBroken("lowest energy", [](std::vector<Row>& rows) {
    for (std::size_t i = 1; i < rows.size(); ++i) {
      setForce(rows[i], -number(rows[i], kForceX), -number(rows[i], kForceX + 1),
               -number(rows[i], kForceX + 2));
    }
  });
}

TEST_F(SamplesRecomputed, AJumpOfTheForceIsFound) {
  expectBroken("rise", [](std::vector<Row>& rows) { setForce(rows[100], 1.1, 0.0, 0.0); });
}

TEST_F(SamplesRecomputed, AForceAboveThePeakIsFound) {
  expectBroken("force", [](std::vector<Row>& rows) {
    for (int i = 0; i < 14; ++i) {  // within the slew: 0.5 N a tick up to 6.5
      setForce(rows[static_cast<std::size_t>(100 + i)], 0.5 * i, 0.0, 0.0);
    }
  });
}

TEST_F(SamplesRecomputed, ALongForceAboveTheContinuousLimitIsFound) {
  expectBroken("above the continuous limit", [](std::vector<Row>& rows) {
    for (std::size_t i = 100; i < 1150; ++i) setForce(rows[i], 1.7, 0.0, 0.0);
  });
}

TEST_F(SamplesRecomputed, ATorqueOfADeviceWithoutMotorsForItIsFound) {
  expectBroken("torque", [](std::vector<Row>& rows) { rows[100][15] = "0.001"; });
}

TEST_F(SamplesRecomputed, WhatIsNoNumberIsRefused) {
  std::vector<Row> rows = rowsOf(simulated("touch-x"));
  rows[100][2] = "nan";
  write(*folder / "spoiled.csv", rows);
  std::string said;
  EXPECT_EQ(recompute(*folder / "spoiled.csv", "touch-x", said), 1);
  EXPECT_NE(said.find("not all are numbers"), std::string::npos) << said;
}

}  // namespace
}  // namespace palpate::test
