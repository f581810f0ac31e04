#include "core/scene/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

namespace palpate {
namespace {

Error cannotWrite(const std::filesystem::path& file, int code) {
  return machineError("The file cannot be written.")
      .inFile(file.string())
      .butFound(std::strerror(code))
      .advise(code == ENOSPC ? "Free space on the disk, or choose another place."
                             : "Check that the folder exists and that you may write there.");
}

bool writeAll(int handle, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(handle, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(handle) == 0;
}

}  // namespace

void syncFolder(const std::filesystem::path& folder) {
  const std::string name = folder.empty() ? "." : folder.string();
  const int handle = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  // Some file systems refuse to sync a folder; the file itself is safe by then.
  (void)::fsync(handle);
  ::close(handle);
}

Result<void> writeWholeFile(const std::filesystem::path& file, std::string_view content) {
  std::string temporary = file.string() + ".XXXXXX";
  const int handle = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (handle < 0) return fail(cannotWrite(file, errno));
  const bool written = writeAll(handle, content);
  const int why = errno;
  ::close(handle);
  if (!written || ::rename(temporary.c_str(), file.c_str()) != 0) {
    const int code = written ? errno : why;
    ::unlink(temporary.c_str());
    return fail(cannotWrite(file, code));
  }
  syncFolder(file.parent_path());
  return {};
}

}  // namespace palpate
