#pragma once
/// Colours of segments as DICOM stores them: CIELab relative to D50, in 16 bits a channel (PS3.3
/// C.10.7.1.1), from and to sRGB.

#include <array>
#include <cstdint>

namespace palpate {

/// L* from 0 to 100 and a*, b* from -128 to 127, each over 0 to 65535.
[[nodiscard]] std::array<std::uint16_t, 3> dicomLabOfRgb(const std::array<std::uint8_t, 3>& rgb);
/// Colours outside sRGB become the nearest of each channel.
[[nodiscard]] std::array<std::uint8_t, 3> rgbOfDicomLab(const std::array<std::uint16_t, 3>& lab);

}  // namespace palpate
