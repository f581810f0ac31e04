#include "imaging/nifti_header.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "imaging/volume_format.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

/// The 348 bytes, read by offset (NIfTI-1 standard, nifti1.h).
class Header {
 public:
  explicit Header(std::string bytes) : bytes_(std::move(bytes)) {
    swapped_ = raw<std::int32_t>(0, false) != 348;
  }
  [[nodiscard]] std::int16_t int16(std::size_t at) const { return raw<std::int16_t>(at, swapped_); }
  [[nodiscard]] double number(std::size_t at) const {
    return static_cast<double>(raw<float>(at, swapped_));
  }
  [[nodiscard]] int byte(std::size_t at) const { return static_cast<unsigned char>(bytes_[at]); }

 private:
  template <class T>
  [[nodiscard]] T raw(std::size_t at, bool swapped) const {
    std::array<char, sizeof(T)> part{};
    std::copy_n(bytes_.data() + at, sizeof(T), part.begin());
    if (swapped) std::reverse(part.begin(), part.end());
    T value;
    std::memcpy(&value, part.data(), sizeof(T));
    return value;
  }
  std::string bytes_;
  bool swapped_ = false;
};

double millimetresPerUnit(const Header& header) {
  switch (header.byte(123) & 7) {
    case 1:
      return 1000.0;  // metres
    case 3:
      return 1e-3;  // micrometres
    default:
      return 1.0;  // millimetres, or not said
  }
}

FoundAffine fromSform(const Header& header) {
  FoundAffine a;
  for (std::size_t row = 0; row < 3; ++row) {
    const std::size_t at = 280 + 16 * row;
    const auto r = static_cast<Eigen::Index>(row);
    for (std::size_t c = 0; c < 3; ++c) {
      a.axes_mm(r, static_cast<Eigen::Index>(c)) = header.number(at + 4 * c);
    }
    a.origin_mm[r] = header.number(at + 12);
  }
  return a;
}

FoundAffine fromQform(const Header& header) {
  const double b = header.number(256);
  const double c = header.number(260);
  const double d = header.number(264);
  const double rest = 1.0 - (b * b + c * c + d * d);
  Eigen::Quaterniond q(rest > 0.0 ? std::sqrt(rest) : 0.0, b, c, d);
  q.normalize();
  FoundAffine a;
  a.axes_mm = q.toRotationMatrix();
  const double handed = header.number(76) < 0.0 ? -1.0 : 1.0;
  a.axes_mm.col(0) *= header.number(80);
  a.axes_mm.col(1) *= header.number(84);
  a.axes_mm.col(2) *= header.number(88) * handed;
  a.origin_mm = {header.number(268), header.number(272), header.number(276)};
  return a;
}

FoundAffine fromSpacing(const Header& header) {
  FoundAffine a;
  a.axes_mm = Eigen::Vector3d(header.number(80), header.number(84), header.number(88)).asDiagonal();
  a.origin_mm.setZero();
  return a;
}

}  // namespace

Result<NiftiPlacement> readNiftiPlacement(const fs::path& file) {
  const std::string bytes = firstBytes(file, 348);
  if (bytes.size() < 348) {
    return fail(inputRefused("The NIfTI header is cut short.")
                    .inFile(file.string())
                    .butFound(std::to_string(bytes.size()) + " bytes")
                    .wants("348 bytes")
                    .advise("Copy the file again from where it came."));
  }
  if (bytes.compare(4, 3, "n+2") == 0) {
    return fail(inputRefused("This is a NIfTI-2 file, which Palpate does not read.")
                    .inFile(file.string())
                    .advise("Save the image as NIfTI-1, NRRD or MetaImage."));
  }
  if (bytes.compare(344, 3, "n+1") != 0) {
    return fail(inputRefused("This NIfTI image is split into a header and an image file.")
                    .inFile(file.string())
                    .wants("one .nii or .nii.gz file")
                    .advise("Save the image as one .nii file."));
  }
  const Header header(bytes);
  NiftiPlacement placement;
  if (header.int16(254) > 0) {
    placement.affine = fromSform(header);
    placement.field = "sform";
  } else if (header.int16(252) > 0) {
    placement.affine = fromQform(header);
    placement.field = "qform";
  } else {
    placement.affine = fromSpacing(header);
    placement.field = "pixdim";
    placement.inPatient = false;
  }
  const double scale = millimetresPerUnit(header);
  placement.affine.axes_mm *= scale;
  placement.affine.origin_mm *= scale;
  // RAS to LPS: x and y of the patient change sign.
  placement.affine.axes_mm.topRows<2>() *= -1.0;
  placement.affine.origin_mm.head<2>() *= -1.0;
  return placement;
}

}  // namespace palpate
