#include "imaging/archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <utility>

#include "core/base/whole_file.h"
#include "imaging/volume_format.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

struct CloseArchive {
  void operator()(archive* a) const noexcept { archive_read_free(a); }
};
using Reader = std::unique_ptr<archive, CloseArchive>;

constexpr std::size_t kBlock = 1U << 18U;
constexpr std::size_t kMaxName = 1024;

Error damaged(const fs::path& file) {
  return inputRefused("The archive is damaged or cut short.")
      .inFile(file.string())
      .advise("Copy it again from where it came, or unpack it and import the folder.");
}

Result<Reader> openArchive(const fs::path& file) {
  Reader reader(archive_read_new());
  // Only what hospitals send; libarchive's exotic readers stay off.
  archive_read_support_filter_gzip(reader.get());
  archive_read_support_filter_bzip2(reader.get());
  archive_read_support_filter_xz(reader.get());
  archive_read_support_filter_zstd(reader.get());
  archive_read_support_format_tar(reader.get());
  archive_read_support_format_gnutar(reader.get());
  archive_read_support_format_zip(reader.get());
  if (archive_read_open_filename(reader.get(), file.c_str(), kBlock) != ARCHIVE_OK) {
    return fail(damaged(file));
  }
  return reader;
}

/// False at the end of the archive.
Result<bool> nextMember(archive* reader, archive_entry*& entry, const fs::path& file) {
  const int status = archive_read_next_header(reader, &entry);
  if (status == ARCHIVE_EOF) return false;
  if (status != ARCHIVE_OK && status != ARCHIVE_WARN) return fail(damaged(file));
  return true;
}

std::string wholeName(archive_entry* entry) {
  const char* name = archive_entry_pathname_utf8(entry);
  if (name == nullptr) name = archive_entry_pathname(entry);
  return name == nullptr ? std::string() : std::string(name);
}

std::string lastName(archive_entry* entry) {
  return fs::path(wholeName(entry)).filename().string();
}

Result<void> copyMember(archive* reader, const fs::path& target, std::uint64_t& left,
                        const fs::path& file) {
  const int fd = ::open(target.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) return fail(cannotWrite(target.parent_path(), errno));
  std::vector<char> block(kBlock);
  Result<void> result;
  while (result) {
    const la_ssize_t got = archive_read_data(reader, block.data(), block.size());
    if (got == 0) break;
    if (got < 0) {
      result = fail(damaged(file));
    } else if (static_cast<std::uint64_t>(got) > left) {
      result = fail(inputRefused("The archive unpacks to more than Palpate accepts.")
                        .inFile(file.string())
                        .advise("Unpack it yourself and import the one series."));
    } else if (::write(fd, block.data(), static_cast<std::size_t>(got)) != got) {
      result = fail(cannotWrite(target.parent_path(), errno != 0 ? errno : ENOSPC));
    } else {
      left -= static_cast<std::uint64_t>(got);
    }
  }
  ::close(fd);
  return result;
}

}  // namespace

Result<PrivateFolder> PrivateFolder::make() {
  std::error_code ec;
  const fs::path base = fs::temp_directory_path(ec);
  std::string pattern = ((ec ? fs::path("/tmp") : base) / "palpate-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return fail(cannotWrite(base, errno));
  return PrivateFolder(pattern);
}

PrivateFolder::PrivateFolder(PrivateFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})) {}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

bool isArchive(const fs::path& file) {
  // firstBytes() looks through gzip; the other compressions are told by their own marks.
  const std::string head = firstBytes(file, 512);
  const auto starts = [&head](const std::string& mark) { return head.rfind(mark, 0) == 0; };
  return starts("PK\x03\x04") || starts("PK\x05\x06") || starts("BZh") ||
         starts(std::string("\xFD"
                            "7zXZ\0",
                            6)) ||
         starts("\x28\xB5\x2F\xFD") || (head.size() > 262 && head.compare(257, 5, "ustar") == 0);
}

bool archiveHolds(const fs::path& file, const std::string& name) {
  auto reader = openArchive(file);
  if (!reader) return false;
  archive_entry* entry = nullptr;
  // A project has a dozen members; looking no further keeps a hostile archive cheap.
  for (int member = 0; member < 1000; ++member) {
    const auto more = nextMember(reader->get(), entry, file);
    if (!more || !*more) return false;
    if (lastName(entry) == name) return true;
  }
  return false;
}

Result<std::vector<char>> readArchiveMember(const fs::path& file, const std::string& name,
                                            std::uint64_t maxBytes) {
  auto reader = openArchive(file);
  if (!reader) return fail(reader.error());
  archive_entry* entry = nullptr;
  for (;;) {
    const auto more = nextMember(reader->get(), entry, file);
    if (!more) return fail(more.error());
    if (!*more) break;
    if (archive_entry_filetype(entry) != AE_IFREG || lastName(entry) != name) continue;
    std::vector<char> bytes;
    std::vector<char> block(kBlock);
    for (;;) {
      const la_ssize_t got = archive_read_data(reader->get(), block.data(), block.size());
      if (got < 0) return fail(damaged(file));
      if (got == 0) return bytes;
      if (bytes.size() + static_cast<std::size_t>(got) > maxBytes) {
        return fail(inputRefused("A part of the archive is larger than it states.")
                        .inFile(file.string())
                        .inField(name)
                        .wants("at most " + std::to_string(maxBytes) + " bytes")
                        .advise("Copy the file again from where it came."));
      }
      bytes.insert(bytes.end(), block.begin(), block.begin() + got);
    }
  }
  return fail(inputRefused("The archive lacks a part.")
                  .inFile(file.string())
                  .inField(name)
                  .butFound("nothing")
                  .advise("Copy the file again from where it came."));
}

Result<std::vector<std::string>> unpackArchive(const fs::path& file, const fs::path& folder,
                                               const UnpackLimits& limits,
                                               const Progress& progress) {
  auto reader = openArchive(file);
  if (!reader) return fail(reader.error());
  std::error_code ec;
  const auto total = static_cast<double>(std::max<std::uintmax_t>(fs::file_size(file, ec), 1));
  std::uint64_t left = limits.bytes;
  archive_entry* entry = nullptr;
  std::vector<std::string> names;
  for (std::size_t member = 0;; ++member) {
    if (progress.cancelled()) return fail(cancelled());
    const auto more = nextMember(reader->get(), entry, file);
    if (!more) return fail(more.error());
    if (!*more) return names;
    if (member >= limits.members) {
      return fail(inputRefused("The archive holds more files than Palpate accepts.")
                      .inFile(file.string())
                      .wants("at most " + std::to_string(limits.members) + " files")
                      .advise("Unpack it yourself and import the one series."));
    }
    names.emplace_back();
    if (archive_entry_filetype(entry) != AE_IFREG) continue;
    if (auto copied = copyMember(reader->get(), folder / std::to_string(member), left, file);
        !copied) {
      return fail(copied.error());
    }
    if (std::string name = wholeName(entry); name.size() <= kMaxName) {
      names.back() = std::move(name);
    }
    progress(static_cast<double>(archive_filter_bytes(reader->get(), -1)) / total, "Unpacking");
  }
}

}  // namespace palpate
