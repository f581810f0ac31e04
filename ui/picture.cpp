#include "ui/picture.h"

#include <png.h>

#include <cstdlib>
#include <cstring>

namespace palpate::ui {

Result<Picture> readPng(const std::filesystem::path& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto refuse = [&] {
    const std::string why = image.message;
    png_image_free(&image);
    return fail(inputRefused("The picture could not be read.").inFile(file.string()).butFound(why));
  };
  if (png_image_begin_read_from_file(&image, file.c_str()) == 0) return refuse();
  image.format = PNG_FORMAT_RGBA;
  Picture picture;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.rgba.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, picture.rgba.data(), 0, nullptr) == 0) return refuse();
  return picture;
}

Result<void> writePng(const Picture& picture, const std::filesystem::path& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGBA;
  const std::filesystem::path part = file.string() + ".part";
  std::error_code error;
  if (png_image_write_to_file(&image, part.c_str(), 0, picture.rgba.data(), 0, nullptr) == 0) {
    std::filesystem::remove(part, error);
    return fail(machineError("The picture could not be written.")
                    .inFile(file.string())
                    .butFound(image.message)
                    .advise("Choose a folder that exists, is writable and has room."));
  }
  std::filesystem::rename(part, file, error);
  if (error) {
    std::filesystem::remove(part, error);
    return fail(machineError("The picture could not be put in its place.").inFile(file.string()));
  }
  return {};
}

PictureDifference compare(const Picture& actual, const Picture& expected) {
  PictureDifference result;
  if (actual.width != expected.width || actual.height != expected.height) {
    result.share = 1.0;
    return result;
  }
  constexpr int kBeyond = 5;  // 2 % of 255
  result.image = actual;
  const std::size_t pixels = actual.rgba.size() / 4;
  for (std::size_t p = 0; p < pixels; ++p) {
    bool beyond = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = actual.rgba[p * 4 + c];
      beyond = beyond || std::abs(a - expected.rgba[p * 4 + c]) > kBeyond;
      result.image.rgba[p * 4 + c] = static_cast<std::uint8_t>(a / 4);
    }
    if (!beyond) continue;
    ++result.pixelsBeyond;
    std::memset(&result.image.rgba[p * 4], 255, 4);
  }
  result.share =
      pixels == 0 ? 0.0 : static_cast<double>(result.pixelsBeyond) / static_cast<double>(pixels);
  return result;
}

}  // namespace palpate::ui
