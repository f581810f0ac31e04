#pragma once
/// The CSV files that `palpate collide` writes (interface.md).

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/collide_trajectory.h"
#include "core/base/error.h"
#include "core/base/whole_file.h"

namespace palpate {

/// `step,contacts,sum_depth_mm,tests,time_us`; numbers as short as they read back exactly.
[[nodiscard]] std::string collideCsv(const std::vector<CollideStep>& steps);

/// The rows of one pose for `step,index,x,y,z,nx,ny,nz,depth_mm,label,flags`: millimetres and
/// normals in W = P of the world (LPS).
[[nodiscard]] std::string collideContactRows(std::int64_t step, std::span<const Contact> contacts_V,
                                             const Eigen::Isometry3d& X_WV);
inline constexpr const char* kCollideContactsHeading =
    "step,index,x,y,z,nx,ny,nz,depth_mm,label,flags\n";

/// A file written piece by piece, for what may not fit into memory; it appears whole at commit()
/// or not at all. A device or pipe is written as it is.
class StagedFile {
 public:
  [[nodiscard]] static Result<StagedFile> create(const std::filesystem::path& file);
  /// False from the first piece on that the disk does not take; finish() then says why.
  [[nodiscard]] bool add(std::string_view text);
  /// Everything is on its way to the disk.
  [[nodiscard]] Result<void> finish();
  /// After finish(): the file gets its name.
  [[nodiscard]] Result<void> commit();

 private:
  explicit StagedFile(std::filesystem::path file) : file_(std::move(file)) {}
  std::filesystem::path file_;
  std::optional<WholeFile> whole_;
  std::ofstream stream_;
  int error_ = 0;
};

}  // namespace palpate
