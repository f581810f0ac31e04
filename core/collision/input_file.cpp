#include "core/collision/input_file.h"

#include <fstream>
#include <iterator>
#include <system_error>

namespace palpate {

Result<std::string> readInputFile(const std::filesystem::path& file) {
  std::error_code ec;
  if (!std::filesystem::exists(file, ec)) {
    return fail(inputRefused("There is no such file.")
                    .inFile(file.string())
                    .advise("Check the path and its spelling."));
  }
  if (std::filesystem::is_directory(file, ec)) {
    return fail(
        inputRefused("This is a folder, not a file.").inFile(file.string()).advise("Name a file."));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream.is_open() || stream.bad()) {
    return fail(inputRefused("The file cannot be read.")
                    .inFile(file.string())
                    .advise("Check that you may read it."));
  }
  return content;
}

}  // namespace palpate
