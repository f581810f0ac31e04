// A PLY file is refused with a sentence, or it gives finite points and unit normals.

#include <cmath>

#include "core/collision/shell_file.h"
#include "tests/fuzz/fuzz_require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const auto shell =
      parseShell(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.ply");
  if (!shell) {
    require(shell.error().kind == ErrorKind::InputRefused, "a file is refused as an input");
    require(!shell.error().message.empty(), "a refusal has a sentence");
    require(shell.error().file == "fuzz.ply", "a refusal names the file");
    return 0;
  }
  require(shell->size() > 0, "a shell has a point");
  for (std::size_t i = 0; i < shell->size(); ++i) {
    require(shell->points_T()[i].allFinite(), "points are finite");
    require(std::abs(shell->normals_T()[i].norm() - 1) < 1e-9, "normals are unit");
  }
  return 0;
}
