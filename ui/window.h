#pragma once
/// The window: GLFW, an OpenGL 3.3 core context and Dear ImGui in it. Main thread only.

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/base/error.h"
#include "ui/fonts.h"
#include "ui/key_queue.h"
#include "ui/picture.h"
#include "ui/theme.h"
#include "ui/ui_script.h"

struct GLFWwindow;

namespace palpate::ui {

struct WindowOptions {
  int width = 1280, height = 800;  ///< Unscaled.
  float scale = 0.0F;              ///< 0: the display's.
  bool light = false;
  bool visible = true;  ///< False: rendered, never mapped (pictures).
  std::filesystem::path fonts = "/usr/share/fonts";
};

class Window {
 public:
  /// Refuses a machine without display or OpenGL 3.3, saying what to do.
  [[nodiscard]] static Result<std::unique_ptr<Window>> open(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Waits up to `timeout` seconds for input, then starts a frame.
  void beginFrame(double timeout);
  /// Draws the frame and shows it.
  void endFrame();

  /// Adds a script's input to this frame; before beginFrame.
  void inject(const ScriptInput& input);
  /// Names of keys that went down since the last call, in order: "space", "escape", "1", "r", ...
  /// None while a text field has the keyboard, but "escape".
  [[nodiscard]] std::deque<std::string> takeKeys();
  [[nodiscard]] bool keyHeld(const std::string& name) const;

  /// From the next frame on the fonts hold the characters of this text, where one has them.
  void needCharacters(const std::string& text);

  void setTheme(bool light);
  [[nodiscard]] const Theme& theme() const noexcept { return theme_; }
  [[nodiscard]] const Fonts& fonts() const noexcept { return fonts_; }
  [[nodiscard]] float scale() const noexcept { return scale_; }
  [[nodiscard]] int width() const noexcept { return width_; }  ///< Framebuffer pixels.
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] bool closing() const;
  void keepOpen();                        ///< Takes a wish to close back.
  [[nodiscard]] Picture picture() const;  ///< Of the last frame; between endFrame and beginFrame.
  [[nodiscard]] bool softwareRendering() const noexcept { return software_; }
  [[nodiscard]] const std::deque<std::filesystem::path>& dropped() const { return dropped_; }
  void clearDropped() { dropped_.clear(); }

 private:
  Window() = default;
  static void onKey(GLFWwindow* window, int key, int scancode, int action, int mods);
  static void onCharacter(GLFWwindow* window, unsigned int character);
  static void onDrop(GLFWwindow* window, int count, const char** paths);
  void keyChanged(int key, bool down);
  void applyInjected();
  void renewFonts();

  GLFWwindow* window_ = nullptr;
  Theme theme_;
  Fonts fonts_;
  RareCharacters rare_;
  std::filesystem::path fontFolder_;
  bool fontsOutdated_ = false;
  float scale_ = 1.0F;
  int width_ = 0, height_ = 0;
  bool software_ = false, imgui_ = false, scripted_ = false;
  KeyQueue typed_;  ///< For Dear ImGui; keys_ and held_ know at once.
  std::deque<std::string> keys_;
  std::map<std::string, bool> held_;
  std::deque<std::filesystem::path> dropped_;
  float mouse_[2] = {-1, -1};
  bool buttons_[3] = {false, false, false};
  float wheel_ = 0.0F;
  std::string text_;
};

}  // namespace palpate::ui
