#include "tests/app/program_run.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "imaging/volume_files.h"

extern char** environ;

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> environmentWith(const std::map<std::string, std::string>& changes) {
  std::vector<std::string> result;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (!changes.contains(text.substr(0, text.find('=')))) result.push_back(text);
  }
  for (const auto& [name, value] : changes) {
    if (!value.empty()) result.push_back(name + "=" + value);
  }
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

pid_t start(const std::vector<std::string>& arguments, const RunSettings& settings,
            const fs::path& out, const fs::path& err) {
  std::vector<std::string> texts{PALPATE_PROGRAM};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment = environmentWith(settings.environment);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t child = -1;
  const int failed = posix_spawn(&child, PALPATE_PROGRAM, &files, nullptr, pointers(texts).data(),
                                 pointers(environment).data());
  posix_spawn_file_actions_destroy(&files);
  EXPECT_EQ(failed, 0) << "could not start " << PALPATE_PROGRAM;
  return failed == 0 ? child : -1;
}

int wait(pid_t child) {
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TempFolder::TempFolder() {
  std::string pattern = (fs::temp_directory_path() / "palpate-test-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

nlohmann::json ProgramRun::json() const {
  return nlohmann::json::parse(out, nullptr, false);
}

std::string ProgramRun::lastErrorLine() const {
  std::string text = err;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

ProgramRun palpate(const std::vector<std::string>& arguments, const RunSettings& settings) {
  const TempFolder folder;
  const fs::path out = settings.stdoutFile.empty() ? folder / "out" : settings.stdoutFile;
  ProgramRun run;
  run.exitCode = wait(start(arguments, settings, out, folder / "err"));
  if (settings.stdoutFile.empty()) run.out = contentOf(out);
  run.err = contentOf(folder / "err");
  return run;
}

ProgramRun palpateInterrupted(const std::vector<std::string>& arguments, int signal,
                              double seconds) {
  const TempFolder folder;
  const pid_t child = start(arguments, {}, folder / "out", folder / "err");
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  if (child > 0) ::kill(child, signal);
  ProgramRun run;
  run.exitCode = wait(child);
  run.out = contentOf(folder / "out");
  run.err = contentOf(folder / "err");
  return run;
}

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void writeText(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::vector<std::string> listing(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".cache") continue;  // interface: may be there, may be deleted
    names.push_back(fs::relative(entry.path(), folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void writeBallScan(const fs::path& file, int slices) {
  Volume volume;
  volume.geometry.dims = {40, 40, slices};
  volume.geometry.spacing = Eigen::Vector3d::Constant(1e-3);
  volume.int16.assign(volume.geometry.voxelCount(), -1000);
  const double middle = (slices - 1) / 2.0;
  for (int k = 0; k < slices; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 40; ++i) {
        const Eigen::Vector3d d(i - 19.5, j - 19.5, k - middle);
        if (d.norm() <= 12.0) volume.int16[volume.geometry.index(i, j, k)] = 1000;
      }
    }
  }
  volume.modality = "CT";
  const Result<void> written = writeVolumeFile(volume, file);
  ASSERT_TRUE(written) << sentence(written.error());
}

bool makeBallCase(const fs::path& folder) {
  const TempFolder scan;
  writeBallScan(scan / "ball.mha");
  const ProgramRun import = palpate({"import", scan / "ball.mha", "--out", folder});
  EXPECT_EQ(import.exitCode, 0) << import.err;
  const ProgramRun segment =
      palpate({"segment", folder, "--threshold", "300", "3071", "--label", "bone"});
  EXPECT_EQ(segment.exitCode, 0) << segment.err;
  return import.exitCode == 0 && segment.exitCode == 0;
}

void expectRefused(const ProgramRun& run, int exitCode, const std::string& kind) {
  EXPECT_EQ(run.exitCode, exitCode) << run.err;
  const nlohmann::json json = run.json();
  ASSERT_TRUE(json.is_object() && json.contains("error")) << run.out;
  EXPECT_EQ(json.size(), 1U);
  const nlohmann::json& error = json["error"];
  EXPECT_EQ(error.size(), 7U);
  for (const char* field : {"file", "field", "found", "expected", "advice"}) {
    ASSERT_TRUE(error.contains(field)) << field;
    EXPECT_TRUE(error[field].is_null() || error[field].is_string()) << field;
  }
  EXPECT_EQ(error["kind"], kind);
  const std::string message = error["message"];
  EXPECT_FALSE(message.empty());
  const std::string line = run.lastErrorLine();
  EXPECT_NE(line.find(message), std::string::npos) << "last line: " << line;
  // A sentence ends with its stop, or with the command to run.
  EXPECT_TRUE(line.back() == '.' || line.find(": palpate ") != std::string::npos) << line;
  EXPECT_TRUE(exitCode == 5 || error["advice"].is_string()) << "nothing to do in: " << line;
}

}  // namespace palpate::test
