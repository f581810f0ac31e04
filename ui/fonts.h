#pragma once
/// Inter with tabular digits, and Font Awesome merged, at the sizes of the window; other scripts
/// from WenQuanYi Micro Hei, as far as what is shown needs them.

#include <imgui.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace palpate::ui {

/// Owned by ImGui's atlas.
struct Fonts {
  ImFont* body = nullptr;       ///< 15 px
  ImFont* secondary = nullptr;  ///< 13 px
  ImFont* strong = nullptr;     ///< 15 px, semibold
  ImFont* heading = nullptr;    ///< 20 px, semibold
};

/// What the shown texts hold beside the characters that the fonts always have: names in Chinese,
/// Japanese, Korean. They are drawn when they are needed: all of them, some 30 000, would slow
/// every start.
class RareCharacters {
 public:
  /// True where one is new: the fonts want to be loaded again.
  bool add(const std::string& utf8);
  /// First and last of each run, then a zero.
  [[nodiscard]] std::vector<ImWchar> ranges() const;

 private:
  std::set<ImWchar> characters_;
};

/// Rebuilds the atlas at `scale`; the caller then renews the renderer's font texture. `folder`
/// holds Debian's truetype/ and opentype/ (usually /usr/share/fonts). Refuses a missing font with
/// the package that has it; without WenQuanYi Micro Hei rare characters show as '?'.
[[nodiscard]] Result<Fonts> loadFonts(const std::filesystem::path& folder, float scale,
                                      const RareCharacters& rare = {});

}  // namespace palpate::ui
