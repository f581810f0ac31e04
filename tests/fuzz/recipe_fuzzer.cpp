// A recipe is refused with a sentence, or its steps, written again, are the same steps.

#include "imaging/segment/recipe.h"
#include "tests/fuzz/fuzz_require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const auto steps =
      parseRecipe(std::string(reinterpret_cast<const char*>(data), size), "fuzz.toml");
  if (!steps) {
    require(steps.error().kind == ErrorKind::InputRefused, "a recipe is refused as an input");
    require(!steps.error().message.empty(), "a refusal has a sentence");
    require(steps.error().file == "fuzz.toml", "a refusal names the file");
    return 0;
  }
  require(!steps->empty(), "a recipe has a step");
  const std::string text = recipeText(*steps);
  const auto again = parseRecipe(text, "again.toml");
  require(again.has_value(), "what was written can be read");
  require(recipeText(*again) == text, "and is the same");
  return 0;
}
