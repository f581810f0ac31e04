#include "core/base/whole_file.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace palpate {
namespace fs = std::filesystem;
namespace {

fs::path folderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// 0, or errno.
int writeAll(const fs::path& file, int flags, std::string_view content) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | flags);
  if (fd < 0) return errno;
  int failed = 0;
  while (!content.empty() && failed == 0) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      failed = errno;
    }
  }
  if (::close(fd) != 0 && failed == 0) failed = errno;
  return failed;
}

}  // namespace

Error cannotWrite(const fs::path& path, int errorNumber) {
  return machineError("The output could not be written: " +
                      std::generic_category().message(errorNumber) + ".")
      .inFile(path.string())
      .advise(errorNumber == ENOSPC
                  ? "Free space on the disk or choose another place; nothing was left behind."
                  : "Choose a place that you may write to; nothing was left behind.");
}

Result<void> flushToDisk(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return fail(cannotWrite(path, errno));
  const int failed = ::fsync(fd) != 0 ? errno : 0;
  ::close(fd);
  // Some file systems cannot flush a folder; the rename is then as safe as they make it.
  if (failed != 0 && failed != EINVAL && failed != EROFS) return fail(cannotWrite(path, failed));
  return {};
}

Result<WholeFile> WholeFile::beside(const fs::path& finalName) {
  const std::string name = finalName.filename().string();
  std::string pattern = (folderOf(finalName) / (".partial-XXXXXX-" + name)).string();
  const int fd = ::mkostemps(pattern.data(), static_cast<int>(name.size() + 1), O_CLOEXEC);
  if (fd < 0) return fail(cannotWrite(finalName, errno));
  ::close(fd);
  return WholeFile(pattern, finalName);
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : hidden_(std::exchange(other.hidden_, {})), final_(std::move(other.final_)) {}

WholeFile& WholeFile::operator=(WholeFile&& other) noexcept {
  std::swap(hidden_, other.hidden_);
  std::swap(final_, other.final_);
  return *this;
}

WholeFile::~WholeFile() {
  if (!hidden_.empty()) ::unlink(hidden_.c_str());
}

Result<void> WholeFile::commit() {
  if (auto flushed = flushToDisk(hidden_); !flushed) {
    flushed.error().file = final_.string();
    return flushed;
  }
  if (::rename(hidden_.c_str(), final_.c_str()) != 0) return fail(cannotWrite(final_, errno));
  hidden_.clear();
  return flushToDisk(folderOf(final_));
}

Result<void> writeWholeFile(const fs::path& output, std::string_view content) {
  std::error_code error;
  const fs::path file = fs::is_symlink(output, error) ? fs::canonical(output, error) : output;
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) {
    // A rename would put a file in the device's place.
    if (const int failed = writeAll(file, 0, content)) return fail(cannotWrite(output, failed));
    return {};
  }
  auto whole = WholeFile::beside(file);
  if (!whole) return fail(whole.error());
  if (const int failed = writeAll(whole->hiddenName(), O_TRUNC, content)) {
    return fail(cannotWrite(output, failed));
  }
  return whole->commit();
}

Result<void> checkWritable(const fs::path& output) {
  std::error_code error;
  fs::path folder = fs::absolute(output, error).lexically_normal().parent_path();
  if (fs::is_directory(output, error)) folder = output;
  while (!fs::exists(folder, error) && folder != folder.parent_path()) {
    if (error && error != std::errc::no_such_file_or_directory) break;
    folder = folder.parent_path();
  }
  if (!fs::is_directory(folder, error)) return fail(cannotWrite(output, ENOTDIR));
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return fail(cannotWrite(output, errno));
  return {};
}

}  // namespace palpate
