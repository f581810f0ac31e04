#pragma once
/// Zip and tar files (plain, gzip, bzip2, xz, zstd) through libarchive, with limits.
///
/// Members never choose where they land: they are numbered files in a private folder, or bytes in
/// memory. Links, devices and folders are skipped. A member that is cut short refuses the archive.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"

namespace palpate {

/// A folder of mode 0700 that is removed, with all in it, when the object goes.
class PrivateFolder {
 public:
  [[nodiscard]] static Result<PrivateFolder> make();
  PrivateFolder(PrivateFolder&& other) noexcept;
  PrivateFolder& operator=(PrivateFolder&&) = delete;
  ~PrivateFolder();
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  explicit PrivateFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

struct UnpackLimits {
  std::uint64_t bytes = std::uint64_t{16} << 30U;  ///< In all, unpacked.
  std::size_t members = 200'000;
};

/// By its first bytes: zip, tar, or a compressed stream that holds a tar.
[[nodiscard]] bool isArchive(const std::filesystem::path& file);
/// Whether a member's last name is `name`.
[[nodiscard]] bool archiveHolds(const std::filesystem::path& file, const std::string& name);
/// The bytes of the first member whose last name is `name`; refused above `maxBytes`, when it is
/// missing, or cut short.
[[nodiscard]] Result<std::vector<char>> readArchiveMember(const std::filesystem::path& file,
                                                          const std::string& name,
                                                          std::uint64_t maxBytes);
/// Every regular member as a numbered file in `folder`: file n has the n-th of the returned names
/// in the archive (empty for what is no regular member, and for names of more than 1024 bytes).
[[nodiscard]] Result<std::vector<std::string>> unpackArchive(const std::filesystem::path& file,
                                                             const std::filesystem::path& folder,
                                                             const UnpackLimits& limits = {},
                                                             const Progress& progress = {});

}  // namespace palpate
