/// Every stroke is seen, and in its order, however many fall into one frame.

#include "ui/key_queue.h"

#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace palpate::ui {
namespace {

using ::testing::ElementsAre;

/// "+257" pressed, "-257" let go, "'a" a character.
std::vector<std::string> taken(KeyQueue& queue) {
  std::vector<std::string> words;
  for (const KeyEvent& e : queue.takeFrame()) {
    std::string word(1, e.key < 0 ? '\'' : e.down ? '+' : '-');
    word += e.key < 0 ? std::string(1, static_cast<char>(e.character)) : std::to_string(e.key);
    words.push_back(word);
  }
  return words;
}

void press(KeyQueue& queue, int key) {
  queue.push({.key = key, .down = true});
}
void letGo(KeyQueue& queue, int key) {
  queue.push({.key = key, .down = false});
}
void type(KeyQueue& queue, char c) {
  press(queue, c - 'a' + GLFW_KEY_A);
  queue.push({.character = static_cast<unsigned char>(c)});
  letGo(queue, c - 'a' + GLFW_KEY_A);
}
void strike(KeyQueue& queue, int key) {
  press(queue, key);
  letGo(queue, key);
}

TEST(KeyQueue, AReturnWithinAFrameIsDownForOne) {
  KeyQueue queue;
  strike(queue, GLFW_KEY_ENTER);
  EXPECT_THAT(taken(queue), ElementsAre("+257"));
  EXPECT_THAT(taken(queue), ElementsAre("-257"));
  EXPECT_TRUE(queue.empty());
}

TEST(KeyQueue, TypingComesThroughInOneFrame) {
  KeyQueue queue;
  for (const char c : {'a', 'b', 'a'}) type(queue, c);
  EXPECT_THAT(taken(queue),
              ElementsAre("+65", "'a", "-65", "+66", "'b", "-66", "+65", "'a", "-65"));
}

TEST(KeyQueue, WhatIsTypedAfterABackspaceWaitsForIt) {
  KeyQueue queue;
  type(queue, 'a');
  strike(queue, GLFW_KEY_BACKSPACE);
  type(queue, 'b');
  EXPECT_THAT(taken(queue), ElementsAre("+65", "'a", "-65", "+259"));
  EXPECT_THAT(taken(queue), ElementsAre("-259", "+66", "'b", "-66"));
}

TEST(KeyQueue, TwoStrokesOfOneKeyAreTwo) {
  KeyQueue queue;
  strike(queue, GLFW_KEY_LEFT);
  strike(queue, GLFW_KEY_LEFT);
  EXPECT_THAT(taken(queue), ElementsAre("+263"));
  EXPECT_THAT(taken(queue), ElementsAre("-263"));
  EXPECT_THAT(taken(queue), ElementsAre("+263"));
  EXPECT_THAT(taken(queue), ElementsAre("-263"));
}

TEST(KeyQueue, ALetterWithControlIsACommandAndKeepsItsControl) {
  KeyQueue queue;
  press(queue, GLFW_KEY_LEFT_CONTROL);
  strike(queue, GLFW_KEY_V);
  letGo(queue, GLFW_KEY_LEFT_CONTROL);
  type(queue, 'a');
  EXPECT_THAT(taken(queue), ElementsAre("+341", "+86"));
  EXPECT_THAT(taken(queue), ElementsAre("-86", "-341", "+65", "'a", "-65"));
}

TEST(KeyQueue, ShiftMakesNoCommandOfALetter) {
  KeyQueue queue;
  press(queue, GLFW_KEY_LEFT_SHIFT);
  type(queue, 'a');
  letGo(queue, GLFW_KEY_LEFT_SHIFT);
  type(queue, 'b');
  EXPECT_EQ(taken(queue).size(), 8U);
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace palpate::ui
