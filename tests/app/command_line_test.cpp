// The rules that hold for every command: usage errors, help, --json, the window's options.

#include <gtest/gtest.h>

#include "tests/app/program_run.h"

namespace palpate::test {
namespace {

struct UsageRow {
  const char* name;
  std::vector<std::string> arguments;
};

class WrongUsage : public testing::TestWithParam<UsageRow> {};

TEST_P(WrongUsage, ExitsWithTwoAndSaysHow) {
  std::vector<std::string> arguments = GetParam().arguments;
  arguments.emplace_back("--json");
  expectRefused(palpate(arguments), 2, "usage");
}

TEST_P(WrongUsage, WithoutJsonStdoutIsEmpty) {
  const ProgramRun run = palpate(GetParam().arguments);
  EXPECT_EQ(run.exitCode, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.lastErrorLine(), "");
}

INSTANTIATE_TEST_SUITE_P(
    Program, WrongUsage,
    testing::Values(
        UsageRow{"UnknownCommand", {"operate"}}, UsageRow{"ImportWithoutPath", {"import"}},
        UsageRow{"ImportWithoutOut", {"import", "scan"}},
        UsageRow{"UnknownRepair", {"import", "scan", "--out", "case", "--repair", "teeth"}},
        UsageRow{"SegmentWithoutHow", {"segment", "case"}},
        UsageRow{"SegmentTwice",
                 {"segment", "case", "--preset", "ct-bone", "--threshold", "1", "2"}},
        UsageRow{"ThresholdOfOneNumber", {"segment", "case", "--threshold", "1"}},
        UsageRow{"ThresholdUpsideDown", {"segment", "case", "--threshold", "300", "-200"}},
        UsageRow{"RecipeWithLabel", {"segment", "case", "--recipe", "r.toml", "--label", "x"}},
        UsageRow{"TreeWithoutLabel", {"tree", "case"}},
        UsageRow{"BranchingOfNine", {"tree", "case", "--label", "x", "--branching", "9"}},
        UsageRow{"UnknownClock", {"simulate", "case", "--clock", "sun"}},
        UsageRow{"NegativeSeconds", {"simulate", "case", "--seconds", "-1"}},
        UsageRow{"ReplayWithoutFile", {"replay"}},
        UsageRow{"TradeoffWithoutOut", {"tradeoff", "c"}},
        UsageRow{"TradeoffOfNothing", {"tradeoff", "--choose"}},
        UsageRow{"TradeoffOfACaseAndAShape", {"tradeoff", "c", "--shape", "plane", "--choose"}},
        UsageRow{"TradeoffOfNoShape", {"tradeoff", "--shape", "cube", "--choose"}},
        UsageRow{"DeadlineWithoutUnit", {"tradeoff", "c", "--choose", "--deadline", "1"}},
        UsageRow{"WindowOptionWithCommand", {"devices", "--screenshot", "a.png"}},
        UsageRow{"UnknownOption", {"devices", "--colour"}}),
    [](const auto& row) { return row.param.name; });

TEST(Program, HelpNamesEveryCommandAndThePurpose) {
  const ProgramRun run = palpate({"--help"});
  EXPECT_EQ(run.exitCode, 0);
  EXPECT_NE(run.out.find("not for diagnosis"), std::string::npos);
  for (const char* name : {"import", "series", "segment", "tree", "simulate", "replay", "tradeoff",
                           "devices", "doctor"}) {
    EXPECT_NE(run.out.find(name), std::string::npos) << name;
  }
}

TEST(Program, HelpOfACommandIsItsOwn) {
  const ProgramRun run = palpate({"tree", "--help"});
  EXPECT_EQ(run.exitCode, 0);
  EXPECT_NE(run.out.find("--branching"), std::string::npos);
}

TEST(Program, HelpAndVersionKeepJson) {
  EXPECT_TRUE(palpate({"--version", "--json"}).json().contains("version"));
  EXPECT_TRUE(palpate({"--help", "--json"}).json().contains("help"));
}

TEST(Program, WithoutDisplaySaysSoAndOffersTheHeadlessRun) {
  const ProgramRun run = palpate({}, {{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}, {}});
  EXPECT_EQ(run.exitCode, 4);
  EXPECT_NE(run.lastErrorLine().find("--headless"), std::string::npos) << run.err;
}

TEST(Program, FullStdoutIsAFailure) {
  const ProgramRun run = palpate({"devices", "--json"}, {{}, "/dev/full"});
  EXPECT_EQ(run.exitCode, 4);
  EXPECT_NE(run.lastErrorLine().find("standard output"), std::string::npos);
}

TEST(Program, MissingDataAreNamed) {
  const TempFolder folder;
  const ProgramRun run = palpate({"simulate", folder.path().string(), "--json"},
                                 {{{"PALPATE_DATA_DIR", (folder / "nowhere").string()}}, {}});
  expectRefused(run, 4, "machine");
  EXPECT_NE(run.err.find("PALPATE_DATA_DIR"), std::string::npos);
}

TEST(Program, JsonStandsBeforeOrAfterTheCommand) {
  EXPECT_TRUE(palpate({"--json", "devices"}).json().is_object());
  EXPECT_TRUE(palpate({"devices", "--json"}).json().is_object());
}

}  // namespace
}  // namespace palpate::test
