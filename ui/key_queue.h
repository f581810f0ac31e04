#pragma once
/// Key strokes on their way to Dear ImGui, a frame's share at a time.
///
/// Dear ImGui knows a key as up or down when a frame starts, and takes the frame's characters
/// before its keys. A stroke can be shorter than a frame (30 ms with software rendering), and
/// several can fall into one: a Return pressed and let go in between would not be seen, and a
/// backspace after a letter would come before it. So no frame's share goes on behind the press of a
/// key that acts.

#include <deque>
#include <set>
#include <vector>

namespace palpate::ui {

struct KeyEvent {
  int key = -1;                ///< GLFW's number; -1: a character.
  bool down = false;           ///< Pressed, not let go.
  unsigned int character = 0;  ///< Unicode, where there is no key.
};

class KeyQueue {
 public:
  void push(const KeyEvent& event) { waiting_.push_back(event); }
  /// What the next frame is to see, in the order it came. The rest waits.
  [[nodiscard]] std::vector<KeyEvent> takeFrame();
  [[nodiscard]] bool empty() const noexcept { return waiting_.empty(); }

 private:
  /// Not a key that only makes a character: Return, the arrows, anything with Ctrl or Alt.
  [[nodiscard]] bool acts(int key) const;
  std::deque<KeyEvent> waiting_;
  std::set<int> modifiers_;  ///< Ctrl, Alt and Super, as the frames have seen them.
};

}  // namespace palpate::ui
