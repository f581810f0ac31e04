#pragma once
/// The layout of a session file, format 3, and how one is opened. Format 2 had no region, left
/// nothing out of the anatomy, and had no part "levels" and no command of a level. Format 1 had no
/// part "pairs" (how materials meet) and steps of one length, so its real-clock sessions open but
/// may not replay.
///
/// SQLite, application_id "PALP", user_version = format. Tables:
///   meta(key, value)          readable: program_version, device, seed, clock, fingerprint, exact,
///                             finished
///   parts(name, hash, data)   the scene (session_scene.h), gains and report; hash = XXH3 of data
///   samples(tick, data)       a ServoSample a servo tick (session_rows.h)
///   steps(step, sample, data) a StepRecord a step
///   commands(number, step, kind, value)  each before the step it acts on
///   events(number, tick, kind, detail)   armed, disarmed, fault, contact-begin, contact-end,
///                             level

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "core/session/database.h"
#include "core/session/session_scene.h"

namespace palpate {

inline constexpr std::int64_t kSessionFormat = 3;
inline constexpr std::int64_t kSessionApplication = 0x50414C50;  // "PALP"

/// For reading. Refuses what is no session, is damaged, or is of a later format.
[[nodiscard]] Result<Database> openSession(const std::filesystem::path& file);
/// Reads every page and index; slow on long sessions.
[[nodiscard]] Result<void> checkWhole(Database& database, const std::filesystem::path& file);
/// All parts, each against its hash.
[[nodiscard]] Result<SessionParts> readParts(Database& database, const std::filesystem::path& file);
/// Empty where there is no such key.
[[nodiscard]] std::string readMeta(Database& database, const std::string& key);

}  // namespace palpate
