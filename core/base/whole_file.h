#pragma once
/// An output that appears whole or not at all (interface.md, "Common rules").
///
/// The bytes go to a hidden file beside the final name, are flushed to the disk, and only then take
/// the name; an old file of that name is untouched until then. A full or unwritable place is
/// ErrorKind::Machine, and nothing is left behind. Not for the loops.

#include <filesystem>
#include <string_view>

#include "core/base/error.h"

namespace palpate {

/// Owns the hidden file until commit(); the destructor removes what was not committed.
class WholeFile {
 public:
  /// Creates the empty hidden file (mode 0600). Its name ends with the final name, so that writers
  /// that choose a format by extension choose rightly.
  [[nodiscard]] static Result<WholeFile> beside(const std::filesystem::path& finalName);
  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&& other) noexcept;
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;
  ~WholeFile();

  [[nodiscard]] const std::filesystem::path& hiddenName() const noexcept { return hidden_; }
  /// Flushes to the disk and renames.
  [[nodiscard]] Result<void> commit();

 private:
  WholeFile(std::filesystem::path hidden, std::filesystem::path finalName)
      : hidden_(std::move(hidden)), final_(std::move(finalName)) {}
  std::filesystem::path hidden_, final_;
};

/// A device or a pipe (/dev/stdout) is written as it is; a symbolic link keeps pointing where it
/// did.
[[nodiscard]] Result<void> writeWholeFile(const std::filesystem::path& file,
                                          std::string_view content);

/// Before long work: would a file or folder of this name be writable? Refuses (Machine) a path
/// through something that is not a folder, or into a folder without leave to write.
[[nodiscard]] Result<void> checkWritable(const std::filesystem::path& output);

/// Flushes a file, or the names in a folder, to the disk.
[[nodiscard]] Result<void> flushToDisk(const std::filesystem::path& path);

/// The sentence for a person, from errno.
[[nodiscard]] Error cannotWrite(const std::filesystem::path& path, int errorNumber);

}  // namespace palpate
