#include "core/devices/shared_library.h"

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <dlfcn.h>
#ifdef __linux__
#include <link.h>
#endif
#endif

namespace palpate {

#ifdef _WIN32

void* openLibrary(const std::string& name, std::string& message) {
  const HMODULE module = LoadLibraryExA(name.c_str(), nullptr, LOAD_LIBRARY_SEARCH_DEFAULT_DIRS);
  if (module != nullptr) return module;
  char text[512] = {};
  const DWORD code = GetLastError();
  FormatMessageA(FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS, nullptr, code, 0, text,
                 sizeof text - 1, nullptr);
  message = text[0] != '\0' ? text : "system error " + std::to_string(code);
  while (!message.empty() && (message.back() == '\n' || message.back() == '\r')) message.pop_back();
  return nullptr;
}

void* findFunction(void* library, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name));
}

std::string libraryFile(void* library, const std::string& name) {
  char path[MAX_PATH] = {};
  const DWORD length = GetModuleFileNameA(static_cast<HMODULE>(library), path, MAX_PATH);
  return length > 0 && length < MAX_PATH ? path : name;
}

#else

void* openLibrary(const std::string& name, std::string& message) {
  dlerror();
  // RTLD_GLOBAL: a vendor's libraries find each other through the global names.
  if (void* library = dlopen(name.c_str(), RTLD_NOW | RTLD_GLOBAL)) return library;
  const char* said = dlerror();
  message = said != nullptr ? said : "the loader gave no reason";
  return nullptr;
}

void* findFunction(void* library, const char* name) {
  return dlsym(library, name);
}

std::string libraryFile(void* library, const std::string& name) {
#ifdef __linux__
  link_map* map = nullptr;
  if (dlinfo(library, RTLD_DI_LINKMAP, &map) == 0 && map != nullptr && map->l_name != nullptr &&
      *map->l_name != '\0') {
    return map->l_name;
  }
#else
  (void)library;
#endif
  return name;
}

#endif

}  // namespace palpate
