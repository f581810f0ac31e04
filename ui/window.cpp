#include "ui/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "ui/gl_api.h"
#include "ui/gl_objects.h"

namespace palpate::ui {
namespace {

constexpr std::pair<int, const char*> kKeyNames[] = {{GLFW_KEY_SPACE, "space"},
                                                     {GLFW_KEY_ESCAPE, "escape"},
                                                     {GLFW_KEY_ENTER, "enter"},
                                                     {GLFW_KEY_BACKSPACE, "backspace"},
                                                     {GLFW_KEY_SLASH, "?"},
                                                     {GLFW_KEY_LEFT, "left"},
                                                     {GLFW_KEY_RIGHT, "right"},
                                                     {GLFW_KEY_PAGE_UP, "pageup"},
                                                     {GLFW_KEY_PAGE_DOWN, "pagedown"},
                                                     {GLFW_KEY_UP, "up"},
                                                     {GLFW_KEY_DOWN, "down"},
                                                     {GLFW_KEY_LEFT_SHIFT, "shift"},
                                                     {GLFW_KEY_RIGHT_SHIFT, "shift"},
                                                     {GLFW_KEY_LEFT_CONTROL, "ctrl"},
                                                     {GLFW_KEY_RIGHT_CONTROL, "ctrl"}};

std::string keyName(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) {
    return std::string(1, static_cast<char>('a' + key - GLFW_KEY_A));
  }
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) {
    return std::string(1, static_cast<char>('0' + key - GLFW_KEY_0));
  }
  for (const auto& [number, name] : kKeyNames) {
    if (number == key) return name;
  }
  return {};
}

/// As the user's keyboard has it: GLFW's names of letters are those of a US keyboard's places.
std::string nameHere(int key) {
  const bool letter = key >= GLFW_KEY_A && key <= GLFW_KEY_Z;
  const char* here = letter ? glfwGetKeyName(key, 0) : nullptr;
  const bool plain = here != nullptr && here[0] >= 'a' && here[0] <= 'z' && here[1] == '\0';
  return plain ? std::string(here) : keyName(key);
}

/// The first with that name; -1 where there is none.
int keyNamed(const std::string& name) {
  for (int key = GLFW_KEY_0; key <= GLFW_KEY_Z; ++key) {
    if (keyName(key) == name) return key;
  }
  for (const auto& [number, known] : kKeyNames) {
    if (known == name) return number;
  }
  return -1;
}

Error noDisplay() {
  const bool none = std::getenv("DISPLAY") == nullptr;
  const char* why = nullptr;
  (void)glfwGetError(&why);
  return machineError(none ? "There is no display to open a window on."
                           : "The window could not be opened with OpenGL 3.3.")
      .butFound(why != nullptr ? why : "no reason given")
      .advise(
          "Start it in a desktop session, or work without a window: `palpate simulate CASE "
          "--headless`.");
}

}  // namespace

Result<std::unique_ptr<Window>> Window::open(const WindowOptions& options) {
  // Software OpenGL would take both cores from the servo loop; one thread draws nearly as fast
  // because the scene is bound by vertices. A GPU's driver ignores the variable.
  ::setenv("LP_NUM_THREADS", "1", 0);
  glfwSetErrorCallback(nullptr);
  if (glfwInit() == GLFW_FALSE) return fail(noDisplay());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
  std::unique_ptr<Window> self(new Window);
  float display = 1.0F;
  if (options.scale > 0.0F) {
    display = options.scale;
  } else if (GLFWmonitor* monitor = glfwGetPrimaryMonitor(); monitor != nullptr) {
    float y = 1.0F;
    glfwGetMonitorContentScale(monitor, &display, &y);
  }
  self->scale_ = std::clamp(display, 0.5F, 4.0F);
  const auto scaled = [&self](int v) {
    return static_cast<int>(static_cast<float>(v) * self->scale_);
  };
  self->window_ =
      glfwCreateWindow(scaled(options.width), scaled(options.height), "Palpate", nullptr, nullptr);
  if (self->window_ == nullptr) return fail(noDisplay());
  glfwSetWindowSizeLimits(self->window_, scaled(1280), scaled(800), GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(self->window_);
  glfwSwapInterval(options.visible ? 1 : 0);
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  self->software_ = renderer != nullptr && (std::strstr(renderer, "llvmpipe") != nullptr ||
                                            std::strstr(renderer, "softpipe") != nullptr);

  ImGui::CreateContext();
  self->imgui_ = true;
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  glfwSetWindowUserPointer(self->window_, self.get());
  glfwSetDropCallback(self->window_, &Window::onDrop);
  if (!ImGui_ImplGlfw_InitForOpenGL(self->window_, true) ||
      !ImGui_ImplOpenGL3_Init("#version 330")) {
    return fail(noDisplay());
  }
  // In place of the backend's own: what is typed reaches it through the queue.
  glfwSetKeyCallback(self->window_, &Window::onKey);
  glfwSetCharCallback(self->window_, &Window::onCharacter);
  self->fontFolder_ = options.fonts;
  auto fonts = loadFonts(options.fonts, self->scale_);
  if (!fonts) return fail(fonts.error());
  self->fonts_ = *fonts;
  io.FontDefault = self->fonts_.body;
  self->setTheme(options.light);
  glfwGetFramebufferSize(self->window_, &self->width_, &self->height_);
  return self;
}

Window::~Window() {
  if (imgui_) {
    if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplOpenGL3_Shutdown();
    if (ImGui::GetIO().BackendPlatformUserData != nullptr) ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  if (window_ != nullptr) glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::onKey(GLFWwindow* window, int key, int, int action, int) {
  if (action == GLFW_REPEAT) return;  // Dear ImGui repeats by itself.
  static_cast<Window*>(glfwGetWindowUserPointer(window))->keyChanged(key, action == GLFW_PRESS);
}

void Window::onCharacter(GLFWwindow* window, unsigned int character) {
  static_cast<Window*>(glfwGetWindowUserPointer(window))->typed_.push({.character = character});
}

void Window::keyChanged(int key, bool down) {
  if (key < 0) return;
  typed_.push({.key = key, .down = down});
  const std::string name = nameHere(key);
  if (name.empty()) return;
  // As the key goes down: by the next frame Ctrl may be up again.
  if (down) keys_.push_back(keyHeld("ctrl") && name != "escape" ? "ctrl+" + name : name);
  held_[name] = down;
}

void Window::onDrop(GLFWwindow* window, int count, const char** paths) {
  auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
  for (int i = 0; i < count; ++i) self->dropped_.emplace_back(paths[i]);
}

void Window::needCharacters(const std::string& text) {
  fontsOutdated_ = rare_.add(text) || fontsOutdated_;
}

void Window::renewFonts() {
  if (!std::exchange(fontsOutdated_, false)) return;
  // Only files that were there at the start can refuse; then the window goes on with what it has.
  const auto fonts = loadFonts(fontFolder_, scale_, rare_);
  if (!fonts) return;
  fonts_ = *fonts;
  ImGui::GetIO().FontDefault = fonts_.body;
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::beginFrame(double timeout) {
  if (timeout > 0.0 && typed_.empty() && !fontsOutdated_) {
    glfwWaitEventsTimeout(timeout);
  } else {
    glfwPollEvents();
  }
  glfwGetFramebufferSize(window_, &width_, &height_);
  renewFonts();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  applyInjected();
  for (const KeyEvent& event : typed_.takeFrame()) {
    if (event.key < 0) {
      ImGui_ImplGlfw_CharCallback(window_, event.character);
    } else {
      ImGui_ImplGlfw_KeyCallback(window_, event.key, 0, event.down ? GLFW_PRESS : GLFW_RELEASE, 0);
    }
  }
  ImGui::NewFrame();
}

void Window::endFrame() {
  ImGui::Render();
  bindWindow(width_, height_);
  const ImVec4& c = theme_.ground;
  glClearColor(c.x, c.y, c.z, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
}

void Window::inject(const ScriptInput& input) {
  scripted_ = true;
  if (input.moveTo) {
    mouse_[0] = input.moveTo->first;
    mouse_[1] = input.moveTo->second;
  }
  if (input.button) buttons_[input.button->first] = input.button->second;
  wheel_ += input.wheel;
  text_ += input.text;
  for (const auto& [name, down] : input.keys) keyChanged(keyNamed(name), down);
}

void Window::applyInjected() {
  if (!scripted_) return;
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = ImVec2(mouse_[0], mouse_[1]);
  for (int i = 0; i < 3; ++i) io.MouseDown[i] = buttons_[i];
  io.MouseWheel = wheel_;
  wheel_ = 0.0F;
  io.AddInputCharactersUTF8(text_.c_str());
  text_.clear();
}

std::deque<std::string> Window::takeKeys() {
  std::deque<std::string> taken;
  taken.swap(keys_);
  if (ImGui::GetIO().WantTextInput)
    std::erase_if(taken, [](const auto& k) { return k != "escape"; });
  return taken;
}

bool Window::keyHeld(const std::string& name) const {
  const auto found = held_.find(name);
  return found != held_.end() && found->second;
}

void Window::setTheme(bool light) {
  theme_ = light ? Theme::bright() : Theme::dark();
  applyTheme(theme_, scale_);
}

bool Window::closing() const {
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void Window::keepOpen() {
  glfwSetWindowShouldClose(window_, GLFW_FALSE);
}

Picture Window::picture() const {
  // Drawn again rather than read from the front buffer, which a compositor may own.
  bindWindow(width_, height_);
  const ImVec4& c = theme_.ground;
  glClearColor(c.x, c.y, c.z, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return {width_, height_, readWindowPixels(width_, height_)};
}

}  // namespace palpate::ui
