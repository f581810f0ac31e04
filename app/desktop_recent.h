#pragma once
/// The list of recent cases, and folders to browse.

#include <filesystem>
#include <vector>

#include "ui/model.h"

namespace palpate {

/// Kept in `userFolder/recent-cases`, one path a line, newest first; private to the user.
class RecentCases {
 public:
  explicit RecentCases(std::filesystem::path userFolder);
  /// Cases that still exist.
  [[nodiscard]] std::vector<ui::RecentCase> list() const;
  void add(const std::filesystem::path& folder);
  void forget(const std::filesystem::path& folder);

 private:
  void write() const;
  std::filesystem::path file_;
  std::vector<std::filesystem::path> folders_;
};

enum class Listed : std::uint8_t { Scans, Labels };
/// Folders, and files that could be scans, or labels and surfaces; sorted, hidden ones left out, at
/// most 500.
[[nodiscard]] std::vector<ui::DirectoryRow> listFolder(const std::filesystem::path& folder,
                                                       Listed listed = Listed::Scans);

}  // namespace palpate
