#include "app/program_paths.h"

#include <cstdlib>
#include <initializer_list>

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path environmentPath(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? fs::path(value) : fs::path();
}

Result<fs::path> dataSubfolder(const char* name) {
  const Result<fs::path> data = programDataFolder();
  if (!data) return fail(data.error());
  return *data / name;
}

}  // namespace

fs::path programFile() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error);
}

Result<fs::path> programDataFolder() {
  const fs::path chosen = environmentPath("PALPATE_DATA_DIR");
  const fs::path folder =
      chosen.empty() ? (programFile().parent_path() / ".." / "share" / "palpate").lexically_normal()
                     : chosen;
  std::error_code error;
  if (fs::is_directory(folder / "datasets", error)) return folder;
  return fail(machineError("The program's own data are not where they should be.")
                  .inFile((folder / "datasets").string())
                  .wants("the folders datasets and shaders")
                  .advise("Install or build the program again, or set PALPATE_DATA_DIR to the "
                          "folder that holds datasets."));
}

Result<fs::path> datasetsFolder() {
  return dataSubfolder("datasets");
}

Result<fs::path> shadersFolder() {
  return dataSubfolder("shaders");
}

fs::path userFolder() {
  const fs::path data = environmentPath("XDG_DATA_HOME");
  if (data.is_absolute()) return data / "palpate";
  return environmentPath("HOME") / ".local" / "share" / "palpate";
}

fs::path demoCaseFolder() {
  return userFolder() / "cases" / "demo-head";
}

fs::path demoScanFile() {
  const Result<fs::path> data = programDataFolder();
  const fs::path beside = data ? *data / "demo" / "Cranium.inv3" : fs::path();
  const fs::path debian = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
  for (const fs::path& file : {environmentPath("PALPATE_DEMO_SCAN"), debian, beside}) {
    std::error_code error;
    if (!file.empty() && fs::is_regular_file(file, error)) return file;
  }
  return {};
}

}  // namespace palpate
