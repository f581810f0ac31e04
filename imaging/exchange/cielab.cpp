#include "imaging/exchange/cielab.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// White of DICOM's profile connection space (ICC.1, D50).
const Eigen::Vector3d kWhite(0.9642, 1.0, 0.8249);

/// Linear sRGB to XYZ under D50, adapted by Bradford (the sRGB profile of the ICC).
const Eigen::Matrix3d& xyzOfLinear() {
  static const Eigen::Matrix3d matrix = [] {
    Eigen::Matrix3d m;
    m << 0.4360747, 0.3850649, 0.1430804,  //
        0.2225045, 0.7168786, 0.0606169,   //
        0.0139322, 0.0971045, 0.7141733;
    // White must be white to the last bit: rows sum to the white point.
    for (Eigen::Index r = 0; r < 3; ++r) m.row(r) *= kWhite[r] / m.row(r).sum();
    return m;
  }();
  return matrix;
}

double linear(double s) {
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

double companded(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

constexpr double kDelta = 6.0 / 29.0;  // CIE 15: where the cube root gives way to a line

double labCurve(double t) {
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

double labCurveInverse(double f) {
  return f > kDelta ? f * f * f : 3.0 * kDelta * kDelta * (f - 4.0 / 29.0);
}

std::uint16_t stored(double value, double low, double high) {
  const double part = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return static_cast<std::uint16_t>(std::lround(part * 65535.0));
}

double shown(std::uint16_t value, double low, double high) {
  return low + (high - low) * value / 65535.0;
}

}  // namespace

std::array<std::uint16_t, 3> dicomLabOfRgb(const std::array<std::uint8_t, 3>& rgb) {
  const Eigen::Vector3d line(linear(rgb[0] / 255.0), linear(rgb[1] / 255.0),
                             linear(rgb[2] / 255.0));
  const Eigen::Vector3d f = (xyzOfLinear() * line).cwiseQuotient(kWhite).unaryExpr(&labCurve);
  return {stored(116.0 * f[1] - 16.0, 0.0, 100.0), stored(500.0 * (f[0] - f[1]), -128.0, 127.0),
          stored(200.0 * (f[1] - f[2]), -128.0, 127.0)};
}

std::array<std::uint8_t, 3> rgbOfDicomLab(const std::array<std::uint16_t, 3>& lab) {
  const double y = (shown(lab[0], 0.0, 100.0) + 16.0) / 116.0;
  const Eigen::Vector3d f(y + shown(lab[1], -128.0, 127.0) / 500.0, y,
                          y - shown(lab[2], -128.0, 127.0) / 200.0);
  const Eigen::Vector3d xyz = f.unaryExpr(&labCurveInverse).cwiseProduct(kWhite);
  const Eigen::Vector3d line = xyzOfLinear().inverse() * xyz;
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double s = companded(std::clamp(line[static_cast<Eigen::Index>(c)], 0.0, 1.0));
    rgb[c] = static_cast<std::uint8_t>(std::lround(s * 255.0));
  }
  return rgb;
}

}  // namespace palpate
