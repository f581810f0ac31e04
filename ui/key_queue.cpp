#include "ui/key_queue.h"

#include <GLFW/glfw3.h>

namespace palpate::ui {
namespace {

bool isShift(int key) {
  return key == GLFW_KEY_LEFT_SHIFT || key == GLFW_KEY_RIGHT_SHIFT;
}

bool isModifier(int key) {
  return key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER && !isShift(key);
}

}  // namespace

bool KeyQueue::acts(int key) const {
  if (isModifier(key) || isShift(key)) return false;
  const bool makesCharacter =
      key < GLFW_KEY_ESCAPE || (key >= GLFW_KEY_KP_0 && key < GLFW_KEY_KP_ENTER);
  return !makesCharacter || !modifiers_.empty();
}

std::vector<KeyEvent> KeyQueue::takeFrame() {
  std::vector<KeyEvent> share;
  std::set<int> letGo;
  while (!waiting_.empty()) {
    const KeyEvent event = waiting_.front();
    const bool press = event.key >= 0 && event.down && acts(event.key);
    // Let go and pressed again in one frame would be one long press.
    if (press && letGo.count(event.key) > 0) break;
    waiting_.pop_front();
    share.push_back(event);
    if (press) break;
    if (event.key >= 0 && !event.down) letGo.insert(event.key);
    if (isModifier(event.key)) {
      if (event.down) {
        modifiers_.insert(event.key);
      } else {
        modifiers_.erase(event.key);
      }
    }
  }
  return share;
}

}  // namespace palpate::ui
