#include "ui/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "ui/gl_api.h"
#include "ui/gl_objects.h"

namespace palpate::ui {
namespace {

std::string keyName(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) {
    return std::string(1, static_cast<char>('a' + key - GLFW_KEY_A));
  }
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) {
    return std::string(1, static_cast<char>('0' + key - GLFW_KEY_0));
  }
  switch (key) {
    case GLFW_KEY_SPACE:
      return "space";
    case GLFW_KEY_ESCAPE:
      return "escape";
    case GLFW_KEY_ENTER:
      return "enter";
    case GLFW_KEY_SLASH:
      return "?";
    case GLFW_KEY_LEFT:
      return "left";
    case GLFW_KEY_RIGHT:
      return "right";
    case GLFW_KEY_PAGE_UP:
      return "pageup";
    case GLFW_KEY_PAGE_DOWN:
      return "pagedown";
    case GLFW_KEY_UP:
      return "up";
    case GLFW_KEY_DOWN:
      return "down";
    case GLFW_KEY_LEFT_SHIFT:
    case GLFW_KEY_RIGHT_SHIFT:
      return "shift";
    case GLFW_KEY_LEFT_CONTROL:
    case GLFW_KEY_RIGHT_CONTROL:
      return "ctrl";
    default:
      return {};
  }
}

int imguiKey(const std::string& name) {
  if (name == "enter") return GLFW_KEY_ENTER;
  if (name == "escape") return GLFW_KEY_ESCAPE;
  if (name == "backspace") return GLFW_KEY_BACKSPACE;
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
  glfwSetKeyCallback(self->window_, &Window::onKey);  // ImGui's backend calls it on.
  glfwSetDropCallback(self->window_, &Window::onDrop);
  if (!ImGui_ImplGlfw_InitForOpenGL(self->window_, true) ||
      !ImGui_ImplOpenGL3_Init("#version 330")) {
    return fail(noDisplay());
  }
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
  auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
  const std::string name = keyName(key);
  if (name.empty()) return;
  if (action == GLFW_PRESS) self->keys_.push_back(name);
  self->held_[name] = action != GLFW_RELEASE;
}

void Window::onDrop(GLFWwindow* window, int count, const char** paths) {
  auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
  for (int i = 0; i < count; ++i) self->dropped_.emplace_back(paths[i]);
}

void Window::beginFrame(double timeout) {
  if (timeout > 0.0) {
    glfwWaitEventsTimeout(timeout);
  } else {
    glfwPollEvents();
  }
  glfwGetFramebufferSize(window_, &width_, &height_);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  applyInjected();
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
  for (const auto& [name, down] : input.keys) {
    if (down) keys_.push_back(name);
    held_[name] = down;
  }
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
  io.KeyShift = keyHeld("shift");
  io.KeyCtrl = keyHeld("ctrl");
  for (const char* name : {"enter", "escape", "backspace"}) {
    io.KeysDown[imguiKey(name)] = keyHeld(name);
  }
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
