#pragma once
/// The scans that Debian packages ship, and folders for tests.

#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace palpate::test {

/// The CT of a head from invesalius-examples; PALPATE_DEMO_SCAN where /usr/share/doc is stripped.
inline std::filesystem::path demoCt() {
  if (const char* scan = std::getenv("PALPATE_DEMO_SCAN")) return scan;
  return "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
}

/// The MR of a head from mricron-data.
inline std::filesystem::path demoMr() {
  return "/usr/share/mricron/templates/ch2.nii.gz";
}

inline std::filesystem::path sharedData() {
  return PALPATE_SHARED_DATA;
}

/// A folder that goes with the test.
class TestFolder {
 public:
  TestFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate::test

#define PALPATE_NEEDS(path, package)                                                    \
  if (!std::filesystem::exists(path)) {                                                 \
    GTEST_SKIP() << "Needs " << (path) << ", which is not here (" << (package) << ")."; \
  }
