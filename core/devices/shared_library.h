#pragma once
/// A library found while the program runs: the one place that knows the system's loader.
///
/// Linux, macOS and Windows (cross-compiled and looked at by the compiler only; never run there).
/// A library once loaded stays. Any thread but the servo's.

#include <string>

namespace palpate {

/// Loads with everything that it needs resolved now, so that a function missing deep inside is
/// found here and not at its first call. Null where it cannot be loaded; `message` is what the
/// system said.
[[nodiscard]] void* openLibrary(const std::string& name, std::string& message);

/// Null where there is none of that name.
[[nodiscard]] void* findFunction(void* library, const char* name);

/// The file as the loader resolved it; `name` where the system does not tell.
[[nodiscard]] std::string libraryFile(void* library, const std::string& name);

}  // namespace palpate
