#include "ui/ui_script.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace palpate::ui {
namespace {

constexpr int kIdleLimit = 3000;  // frames

int buttonNumber(const std::string& name) {
  return name == "right" ? 1 : name == "middle" ? 2 : 0;
}

float number(const std::string& word) {
  return std::strtof(word.c_str(), nullptr);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// How many words a verb wants, least and most; nothing for an unknown verb.
std::optional<std::pair<std::size_t, std::size_t>> arity(const std::string& verb) {
  static const std::map<std::string, std::pair<std::size_t, std::size_t>> kArity{
      {"move", {2, 2}},  {"move-item", {1, 9}},  {"press", {1, 1}},     {"release", {1, 1}},
      {"click", {2, 3}}, {"click-item", {1, 9}}, {"double", {2, 2}},    {"drag", {4, 5}},
      {"wheel", {1, 1}}, {"key", {1, 1}},        {"hold", {1, 1}},      {"let", {1, 1}},
      {"text", {1, 99}}, {"wait", {1, 1}},       {"wait-idle", {0, 0}}, {"screenshot", {1, 1}},
      {"phase", {1, 9}}, {"quit", {0, 0}}};
  const auto found = kArity.find(verb);
  if (found == kArity.end()) return std::nullopt;
  return found->second;
}

}  // namespace

bool UiScript::expand(const Step& step, std::deque<Step>& out) {
  const auto add = [&](std::string verb, std::vector<std::string> words) {
    out.push_back({std::move(verb), std::move(words), step.line, 0});
  };
  const auto& w = step.words;
  const auto button = [&w](std::size_t at) { return w.size() > at ? w[at] : std::string("left"); };
  if (step.verb == "click" || step.verb == "double") {
    add("move", {w[0], w[1]});
    for (int i = step.verb == "click" ? 1 : 0; i < 2; ++i) {
      add("press", {button(2)});
      add("release", {button(2)});
    }
  } else if (step.verb == "click-item") {
    add("move-item", w);
    add("press", {"left"});
    add("release", {"left"});
  } else if (step.verb == "drag") {
    add("move", {w[0], w[1]});
    add("press", {button(4)});
    for (int i = 1; i <= 8; ++i) {
      const float f = static_cast<float>(i) / 8.0F;
      add("move", {std::to_string(number(w[0]) + f * (number(w[2]) - number(w[0]))),
                   std::to_string(number(w[1]) + f * (number(w[3]) - number(w[1])))});
    }
    add("release", {button(4)});
  } else if (step.verb == "key") {
    add("hold", w);
    add("let", w);
  } else {
    out.push_back(step);
  }
  return true;
}

Result<UiScript> UiScript::read(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    return fail(inputRefused("The ui script could not be opened.").inFile(file.string()));
  }
  std::ostringstream text;
  text << in.rdbuf();
  return parse(text.str(), file.string());
}

Result<UiScript> UiScript::parse(const std::string& text, const std::string& name) {
  UiScript script;
  script.name_ = name;
  std::istringstream lines(text);
  std::string line;
  for (int at = 1; std::getline(lines, line); ++at) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    Step step;
    step.line = at;
    if (!(words >> step.verb)) continue;
    for (std::string word; words >> word;) step.words.push_back(word);
    const auto wanted = arity(step.verb);
    if (!wanted || step.words.size() < wanted->first || step.words.size() > wanted->second) {
      return fail(inputRefused("A line of the ui script is not a command.")
                      .inFile(name)
                      .inField("line " + std::to_string(at))
                      .butFound(line)
                      .advise("See ui/ui_script.h for the commands."));
    }
    (void)expand(step, script.steps_);
  }
  return script;
}

Result<ScriptInput> UiScript::next(const std::map<std::string, Rect>& items, bool idle) {
  ScriptInput input;
  if (steps_.empty()) return input;
  Step& step = steps_.front();
  const auto& w = step.words;
  if (step.verb == "wait" || step.verb == "wait-idle") {
    const int limit = step.verb == "wait" ? std::atoi(w[0].c_str()) : kIdleLimit;
    // Idle needs a few frames of grace: a job starts the frame after its button.
    const bool done = step.verb == "wait-idle" && idle && step.waited >= 3;
    if (++step.waited >= limit || done) steps_.pop_front();
    return input;
  }
  if (step.verb == "move") input.moveTo = {number(w[0]), number(w[1])};
  if (step.verb == "move-item") {
    const auto found = items.find(joined(w));
    if (found == items.end()) {
      return fail(checkFailed("The ui script names a control that is not on the screen.")
                      .inFile(name_)
                      .inField("line " + std::to_string(step.line))
                      .butFound(joined(w)));
    }
    const Rect& r = found->second;
    input.moveTo = {r.x + 0.5F * r.w, r.y + 0.5F * r.h};
  }
  if (step.verb == "press") input.button = {buttonNumber(w[0]), true};
  if (step.verb == "release") input.button = {buttonNumber(w[0]), false};
  if (step.verb == "wheel") input.wheel = number(w[0]);
  if (step.verb == "hold") input.keys.emplace_back(w[0], true);
  if (step.verb == "let") input.keys.emplace_back(w[0], false);
  if (step.verb == "text") input.text = joined(w);
  if (step.verb == "screenshot") input.screenshot = w[0];
  if (step.verb == "phase") input.phase = joined(w);
  if (step.verb == "quit") input.quit = true;
  steps_.pop_front();
  return input;
}

}  // namespace palpate::ui
