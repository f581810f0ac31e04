#pragma once
/// A prepared scene as named parts of a session, and back: everything a replay needs.
///
/// Only felt labels are kept; others are background in the session. The scene's own name is left
/// out, as people name scenes after patients.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/session/pack.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

using SessionParts = std::map<std::string, std::vector<std::uint8_t>>;

[[nodiscard]] SessionParts partsOf(const PreparedScene& scene);

/// The scene alone, without the anatomy. Refuses parts that are missing or damaged by name.
[[nodiscard]] Result<Scene> sceneOf(const SessionParts& parts, const std::string& file);

[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> prepareParts(const SessionParts& parts,
                                                                        const std::string& file,
                                                                        const Progress& progress);

/// "The session file is damaged.", with the part that is.
[[nodiscard]] Error damaged(const std::string& file, const std::string& part);

}  // namespace palpate
