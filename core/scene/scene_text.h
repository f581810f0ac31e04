#pragma once
/// A scene as the text of scene.toml, for files and for sessions that carry their scene.

#include <string>

#include "core/scene/scene.h"

namespace palpate {

[[nodiscard]] std::string sceneText(const Scene& scene);
/// `path` is only for messages; keys that are absent are taken from `absent`.
[[nodiscard]] Result<Scene> sceneFromText(const std::string& text, const std::string& path,
                                          const Scene& absent = {});

}  // namespace palpate
