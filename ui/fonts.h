#pragma once
/// Inter with tabular digits, and Font Awesome merged, at the sizes of the window.

#include <imgui.h>

#include <filesystem>

#include "core/base/error.h"

namespace palpate::ui {

/// Owned by ImGui's atlas.
struct Fonts {
  ImFont* body = nullptr;       ///< 15 px
  ImFont* secondary = nullptr;  ///< 13 px
  ImFont* strong = nullptr;     ///< 15 px, semibold
  ImFont* heading = nullptr;    ///< 20 px, semibold
};

/// Rebuilds the atlas at `scale`; the caller then renews the renderer's font texture. `folder`
/// holds Debian's truetype/ and opentype/ (usually /usr/share/fonts). Refuses a missing font with
/// the package that has it.
[[nodiscard]] Result<Fonts> loadFonts(const std::filesystem::path& folder, float scale);

}  // namespace palpate::ui
