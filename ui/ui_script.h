#pragma once
/// Input from a file instead of a hand, so that a test drives the window frame by frame.
///
/// One command a line; '#' starts a comment. Pixels are of the framebuffer, from the top left.
///   move X Y | move-item NAME        press|release left|right|middle
///   click X Y [BUTTON] | click-item NAME | double X Y
///   drag X1 Y1 X2 Y2 [BUTTON]        wheel STEPS
///   key NAME                         hold NAME / let NAME   (a key, or shift, ctrl)
///   text WORDS                       wait FRAMES | wait-idle (no job runs; at most 3000 frames)
///   screenshot FILE                  quit
///   phase NAME                       (of what follows, in the report of the frames)
/// Every command but screenshot and quit takes at least one frame. NAME is the label of a control.

#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "ui/layout.h"

namespace palpate::ui {

/// What a frame of a script does to the input.
struct ScriptInput {
  std::optional<std::pair<float, float>> moveTo;
  std::optional<std::pair<int, bool>> button;  ///< Which (0 left, 1 right, 2 middle), down.
  float wheel = 0.0F;
  std::vector<std::pair<std::string, bool>> keys;  ///< Name, down.
  std::string text;
  std::optional<std::filesystem::path> screenshot;  ///< After this frame is drawn.
  std::optional<std::string> phase;                 ///< Begins with this frame.
  bool quit = false;
};

class UiScript {
 public:
  /// Refuses a line that is not a command, by number.
  [[nodiscard]] static Result<UiScript> read(const std::filesystem::path& file);
  [[nodiscard]] static Result<UiScript> parse(const std::string& text, const std::string& name);

  /// Input of the next frame. `items`: where the controls of the last frame are. An unknown item
  /// ends the script with an error.
  [[nodiscard]] Result<ScriptInput> next(const std::map<std::string, Rect>& items, bool idle);
  [[nodiscard]] bool finished() const noexcept { return steps_.empty(); }

 private:
  struct Step {
    std::string verb;
    std::vector<std::string> words;
    int line = 0;
    int waited = 0;
  };
  [[nodiscard]] static bool expand(const Step& step, std::deque<Step>& out);
  std::string name_;
  std::deque<Step> steps_;
};

}  // namespace palpate::ui
