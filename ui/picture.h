#pragma once
/// Pictures in and out as PNG, and how far two are apart (golden pictures).

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/error.h"

namespace palpate::ui {

/// RGBA, sRGB, top row first.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

[[nodiscard]] Result<Picture> readPng(const std::filesystem::path& file);
/// Whole or not at all.
[[nodiscard]] Result<void> writePng(const Picture& picture, const std::filesystem::path& file);

struct PictureDifference {
  std::size_t pixelsBeyond = 0;  ///< Any colour channel off by more than 2 % of full scale.
  double share = 0.0;            ///< Of all pixels; 1 where the sizes differ.
  Picture image;                 ///< White where beyond, dimmed elsewhere; empty on other sizes.
};
[[nodiscard]] PictureDifference compare(const Picture& actual, const Picture& expected);

}  // namespace palpate::ui
