#include "app/collide_files.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>

#include "core/geometry/units.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

template <class T>
void append(std::string& text, T value, char after) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
  text.push_back(after);
}

}  // namespace

std::string collideCsv(const std::vector<CollideStep>& steps) {
  std::string text = "step,contacts,sum_depth_mm,tests,time_us\n";
  for (const CollideStep& step : steps) {
    append(text, step.step, ',');
    append(text, step.contacts, ',');
    append(text, step.sumDepth_mm, ',');
    append(text, step.tests, ',');
    append(text, step.time_us, '\n');
  }
  return text;
}

std::string collideContactRows(std::int64_t step, std::span<const Contact> contacts_V,
                               const Eigen::Isometry3d& X_WV) {
  std::string rows;
  for (const Contact& contact : contacts_V) {
    const Eigen::Vector3d p = X_WV * Eigen::Vector3d(contact.p[0], contact.p[1], contact.p[2]);
    const Eigen::Vector3d n =
        X_WV.linear() * Eigen::Vector3d(contact.n[0], contact.n[1], contact.n[2]);
    append(rows, step, ',');
    append(rows, contact.shellIndex, ',');
    for (int a = 0; a < 3; ++a) append(rows, millimetres(p[a]), ',');
    for (int a = 0; a < 3; ++a) append(rows, n[a], ',');
    append(rows, millimetres(contact.depth), ',');
    append(rows, static_cast<unsigned>(contact.label), ',');
    append(rows, static_cast<unsigned>(contact.flags), '\n');
  }
  return rows;
}

Result<StagedFile> StagedFile::create(const fs::path& file) {
  std::error_code error;
  StagedFile staged(fs::is_symlink(file, error) ? fs::canonical(file, error) : file);
  errno = 0;
  if (fs::exists(staged.file_, error) && !fs::is_regular_file(staged.file_, error)) {
    staged.stream_.open(staged.file_, std::ios::binary);
  } else {
    auto whole = WholeFile::beside(staged.file_);
    if (!whole) return fail(whole.error());
    staged.whole_.emplace(std::move(*whole));
    staged.stream_.open(staged.whole_->hiddenName(), std::ios::binary);
  }
  if (!staged.stream_) return fail(cannotWrite(file, errno != 0 ? errno : EIO));
  return staged;
}

bool StagedFile::add(std::string_view text) {
  if (!stream_) return false;
  errno = 0;
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream_) error_ = errno != 0 ? errno : EIO;
  return error_ == 0;
}

Result<void> StagedFile::finish() {
  if (error_ == 0) {
    errno = 0;
    stream_.close();
    if (!stream_) error_ = errno != 0 ? errno : EIO;
  }
  if (error_ != 0) return fail(cannotWrite(file_, error_));
  return {};
}

Result<void> StagedFile::commit() {
  if (!whole_) return {};
  return whole_->commit();
}

}  // namespace palpate
