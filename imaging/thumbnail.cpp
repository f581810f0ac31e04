#include "imaging/thumbnail.h"

#include <algorithm>
#include <cmath>

#include "imaging/dicom_pixels.h"

namespace palpate {
namespace {

// A list must stay quick: an image file with more frames, or larger, has no picture.
constexpr std::size_t kMostPixels = std::size_t{1} << 26U;

std::vector<std::int32_t> middleSlice(const std::vector<DicomFile>& files,
                                      const DicomStack& stack) {
  const FrameRef& ref = stack.slices[stack.slices.size() / 2];
  const DicomFile& file = files[ref.file];
  std::vector<std::int32_t> values;
  if (std::size_t{file.rows} * file.columns * file.frames.size() > kMostPixels) return values;
  const auto decoded = decodeDicomFrames(file, [&](std::uint32_t frame, auto all) {
    if (frame == ref.frame) values.assign(all.begin(), all.end());
  });
  if (!decoded) values.clear();
  return values;
}

/// Each picture pixel is the mean of the image pixels that it covers.
GreyPicture shrunk(const std::vector<std::int32_t>& values, int columns, int rows, int width,
                   int height, double low, double high) {
  GreyPicture picture{width, height, {}};
  for (int y = 0; y < height; ++y) {
    const int top = static_cast<int>(std::int64_t{y} * rows / height);
    const int bottom = std::max(top + 1, static_cast<int>(std::int64_t{y + 1} * rows / height));
    for (int x = 0; x < width; ++x) {
      const int left = static_cast<int>(std::int64_t{x} * columns / width);
      const int right = std::max(left + 1, static_cast<int>(std::int64_t{x + 1} * columns / width));
      double sum = 0.0;
      for (int j = top; j < bottom; ++j) {
        for (int i = left; i < right; ++i) {
          sum += values[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(i)];
        }
      }
      const double mean = sum / ((bottom - top) * (right - left));
      const double grey = std::clamp((mean - low) / std::max(high - low, 1.0), 0.0, 1.0);
      picture.grey.push_back(static_cast<std::uint8_t>(std::lround(255.0 * grey)));
    }
  }
  return picture;
}

}  // namespace

std::optional<GreyPicture> thumbnailOf(const std::vector<DicomFile>& files,
                                       const DicomStack& stack) {
  if (stack.slices.empty()) return std::nullopt;
  const auto values = middleSlice(files, stack);
  if (values.empty()) return std::nullopt;
  const FrameRef& ref = stack.slices[stack.slices.size() / 2];
  const DicomFile& file = files[ref.file];
  auto sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const double low = sorted[sorted.size() / 100];
  const double high = sorted[sorted.size() - 1 - sorted.size() / 100];
  const DicomFrame& frame = file.frames[ref.frame];
  const bool sized = frame.hasSpacing && frame.spacing_mm.minCoeff() > 0.0;
  const double wide = file.columns * (sized ? frame.spacing_mm.x() : 1.0);
  const double tall = file.rows * (sized ? frame.spacing_mm.y() : 1.0);
  const double scale = kThumbnailSide / std::max(wide, tall);
  const auto side = [scale](double length) {
    return std::clamp(static_cast<int>(std::lround(length * scale)), 1, kThumbnailSide);
  };
  GreyPicture picture = shrunk(values, static_cast<int>(file.columns), static_cast<int>(file.rows),
                               side(wide), side(tall), low, high);
  if (file.photometric == "MONOCHROME1") {
    for (std::uint8_t& g : picture.grey) g = static_cast<std::uint8_t>(255 - g);
  }
  return picture;
}

}  // namespace palpate
