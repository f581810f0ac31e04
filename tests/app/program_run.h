#pragma once
/// Runs the program as a user would, and gives what came out. For tests/app and tests/stories.

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::test {

/// A folder of its own, removed with everything in it.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

struct ProgramRun {
  int exitCode = -1;  ///< 128 + signal where a signal ended it.
  std::string out, err;
  /// stdout as exactly one JSON value; discarded() where it is not.
  [[nodiscard]] nlohmann::json json() const;
  [[nodiscard]] std::string lastErrorLine() const;
};

struct RunSettings {
  std::map<std::string, std::string> environment;  ///< Added; an empty value removes.
  std::filesystem::path stdoutFile;                ///< Instead of ProgramRun::out.
};

/// Starts `palpate arguments...` and waits.
[[nodiscard]] ProgramRun palpate(const std::vector<std::string>& arguments,
                                 const RunSettings& settings = {});
/// Starts it, sends `signal` after `seconds`, and waits.
[[nodiscard]] ProgramRun palpateInterrupted(const std::vector<std::string>& arguments, int signal,
                                            double seconds);

[[nodiscard]] std::string contentOf(const std::filesystem::path& file);
void writeText(const std::filesystem::path& file, const std::string& text);
/// Every file and folder below but caches, sorted: to see that nothing was left behind.
[[nodiscard]] std::vector<std::string> listing(const std::filesystem::path& folder);

/// A ball of 1000 HU, radius 12 mm, in air of -1000 HU: 40 x 40 x `slices` voxels of 1 mm, .mha.
void writeBallScan(const std::filesystem::path& file, int slices = 40);
/// The ball imported and segmented into `bone`. False (with gtest failures) where that fails.
[[nodiscard]] bool makeBallCase(const std::filesystem::path& folder);

/// interface.md: the exit code, one JSON error object with its seven fields, and a last line on
/// stderr that is a sentence with something to do.
void expectRefused(const ProgramRun& run, int exitCode, const std::string& kind);

}  // namespace palpate::test
