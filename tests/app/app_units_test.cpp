// The parts of app/ that do not need the program: tables, durations, files, the error object.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <pugixml.hpp>

#include "app/accuracy.h"
#include "app/console.h"
#include "app/duration_text.h"
#include "app/grid_report.h"
#include "app/run_sinks.h"
#include "app/setting_report.h"
#include "app/svg_picture.h"
#include "app/text_table.h"
#include "app/trade_plots.h"
#include "app/trade_report.h"
#include "app/wakeup_jitter.h"
#include "tests/app/program_run.h"

namespace palpate {
namespace {

TEST(TextTable, AlignsByWhatIsSeen) {
  TextTable table({"a", "b"});
  table.add({"µm", "1"});
  table.add({"long", "22"});
  EXPECT_EQ(table.text(), "a     b\nµm    1\nlong  22\n");
}

TEST(TextTable, NumbersThatAreNotAreADash) {
  EXPECT_EQ(decimal(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(decimal(1.005, 1), "1.0");
  EXPECT_EQ(byteSize(1023), "1023 B");
  EXPECT_EQ(byteSize(1536), "1.5 KiB");
  EXPECT_EQ(byteSize(3 * 1024 * 1024), "3.0 MiB");
}

TEST(Duration, TakesUnitsAndNothingElse) {
  EXPECT_DOUBLE_EQ(*parseDuration("1ms", "--deadline"), 1e-3);
  EXPECT_DOUBLE_EQ(*parseDuration("500us", "--deadline"), 500e-6);
  EXPECT_DOUBLE_EQ(*parseDuration("0.001s", "--deadline"), 1e-3);
  for (const char* text : {"", "1", "ms", "-1ms", "0ms", "1 ms", "1min", "nanms", "infs"}) {
    const Result<double> duration = parseDuration(text, "--deadline");
    ASSERT_FALSE(duration) << text;
    EXPECT_EQ(duration.error().kind, ErrorKind::Usage);
    EXPECT_EQ(duration.error().found, text);
  }
}

TEST(ErrorObject, HasSevenFieldsAndNulls) {
  const auto json = errorObject(machineError("Disk\nfull.").inFile("a").advise("Free it."));
  const auto& error = json["error"];
  EXPECT_EQ(error.size(), 7U);
  EXPECT_EQ(error["kind"], "machine");
  EXPECT_EQ(error["message"], "Disk full.") << "one line";
  EXPECT_EQ(error["file"], "a");
  EXPECT_TRUE(error["field"].is_null());
  EXPECT_TRUE(error["found"].is_null());
  EXPECT_TRUE(error["expected"].is_null());
  EXPECT_EQ(error["advice"], "Free it.");
}

TEST(GridReport, DirectionIsColumnAfterColumn) {
  GridGeometry geometry;
  geometry.dims = {2, 3, 4};
  geometry.spacing = {0.95703e-3, 0.95703e-3, 1.5e-3};
  Eigen::Matrix3d turn;
  turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // x of V points along y of P
  geometry.X_PV.linear() = turn;
  geometry.X_PV.translation() = Eigen::Vector3d(0.001, -0.002, 0.0);
  nlohmann::ordered_json json;
  addGridFields(json, geometry);
  EXPECT_EQ(json["direction"], nlohmann::json({0, 1, 0, 0, 0, 1, 1, 0, 0}));
  EXPECT_EQ(json["spacing_mm"].dump(), "[0.95703,0.95703,1.5]");
  EXPECT_EQ(json["origin_mm"].dump(), "[1.0,-2.0,0.0]");
}

TEST(SettingReport, HashesAreSixteenDigits) {
  EXPECT_EQ(hashText(0), "0000000000000000");
  EXPECT_EQ(hashText(0xABCDEF0123456789ULL), "abcdef0123456789");
}

TEST(SampleSink, CountsWhatFindsNoRoom) {
  SampleSink sink(2);
  ServoSample sample;
  EXPECT_TRUE(sink.onTick(sample));
  EXPECT_TRUE(sink.onTick(sample));
  EXPECT_FALSE(sink.onTick(sample));
  EXPECT_EQ(sink.dropped(), 1U);
  const std::string csv = sink.csv();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
}

TEST(SampleSink, WritesFieldsInOrder) {
  ServoSample sample;
  sample.device.t = 0.25;
  sample.device.pose = {{1, 2, 3}, {0.5, -0.5, 0.5, -0.5}};
  sample.device.v[0] = 4;
  sample.device.v[1] = 5;
  sample.device.v[2] = 6;
  for (int i = 0; i < 3; ++i) sample.wrench.force[i] = 7 + i;
  for (int i = 0; i < 3; ++i) sample.wrench.torque[i] = 10 + i;
  sample.contacts = 13;
  sample.depth = 0.014;
  sample.toolStep = 15;
  SampleSink sink(1);
  ASSERT_TRUE(sink.onTick(sample));
  const std::string csv = sink.csv();
  EXPECT_EQ(csv.substr(csv.find('\n') + 1),
            "0.25,1,2,3,0.5,-0.5,0.5,-0.5,4,5,6,7,8,9,10,11,12,13,0.014,15\n");
}

TEST(TeeSink, TellsOfADropInAny) {
  SampleSink full(0), roomy(1);
  TeeSink tee;
  EXPECT_EQ(tee.orNull(), nullptr);
  tee.add(full);
  tee.add(roomy);
  EXPECT_FALSE(tee.onTick({}));
  EXPECT_EQ(roomy.dropped(), 0U) << "the others still get it";
}

TEST(Jitter, PercentilesByNearestRank) {
  std::vector<double> lateness;
  for (int i = 1; i <= 1000; ++i) lateness.push_back(i);  // 1 .. 1000 µs
  const JitterReport report = summariseLateness(lateness);
  EXPECT_EQ(report.wakeups, 1000U);
  EXPECT_EQ(report.p50_us, 500.0);
  EXPECT_EQ(report.p99_us, 990.0);
  EXPECT_EQ(report.p999_us, 999.0);
  EXPECT_EQ(report.max_us, 1000.0);
  EXPECT_EQ(report.late, 900U);
  EXPECT_EQ(report.missed, 0U);
}

TEST(Jitter, AMissedPeriodIsCountedOnceAPeriod) {
  EXPECT_EQ(summariseLateness({3500.0}).missed, 3U);
  EXPECT_EQ(summariseLateness({}).wakeups, 0U);
}

TradeReport threePoints() {
  TradeReport report;
  for (int i = 0; i < 3; ++i) {
    TradePoint point;
    point.name = std::array{"p0", "a<b & \"c\"", "p2"}[static_cast<std::size_t>(i)];
    if (i == 1) point.option.push_back('a');
    point.errors.force_N.p95 = 0.1 * i;
    point.cost.p99_us = 300.0 / (i + 1);
    point.promise = {0.1 * i, 0.0, 300.0};
    point.onFront = i != 1;
    report.sweep.points.push_back(point);
  }
  report.sweep.points[0].name = "default";
  report.sweep.growth.push_back(fitGrowth("time", "contacts", {1, 2}, {1, 4}));
  report.chosen = report.sweep.points[2];
  report.checked = report.chosen;
  return report;
}

TEST(TradeReport, FrontIsSortedByTime) {
  const auto json = tradeJson(threePoints());
  ASSERT_EQ(json["front"].size(), 2U);
  EXPECT_EQ(json["front"][0]["name"], "p2");
  EXPECT_EQ(json["front"][1]["name"], "default");
  EXPECT_EQ(json["points"].size(), 3U);
  EXPECT_EQ(json["chosen"]["name"], "p2");
  EXPECT_EQ(json["chosen"]["checked"]["held"], true);
  EXPECT_EQ(json["growth"][0]["exponent"], 2.0);
  EXPECT_TRUE(json["growth"][0]["confidence_95"][0].is_null());  // two points tell nothing
}

TEST(TradeReport, APromiseIsHeldWithinATenth) {
  TradePoint chosen, checked;
  chosen.promise = {0.2, 0.1, 50.0};
  checked.errors.force_N.p95 = 0.221;
  checked.cost.p999_us = 54.0;
  EXPECT_TRUE(promiseHeld(chosen, checked));
  checked.errors.force_N.p95 = 0.223;
  EXPECT_FALSE(promiseHeld(chosen, checked));
  checked.errors.force_N.p95 = 0.1;
  checked.cost.p999_us = 56.0;
  EXPECT_FALSE(promiseHeld(chosen, checked));
  EXPECT_THAT(tradeText(threePoints()), testing::HasSubstr("the promise holds within 10 %"));
}

TEST(TradeReport, ThePicturesAreWellFormedAndBecomePng) {
  for (const std::string& svg : {frontSvg(threePoints()), optionsSvg(threePoints())}) {
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(svg.c_str())) << svg;
    const double width = document.child("svg").attribute("width").as_double();
    const double height = document.child("svg").attribute("height").as_double();
    for (const auto& node : document.child("svg").children()) {
      for (const char* name : {"cx", "x", "x1", "x2"}) {
        const double x = node.attribute(name).as_double();
        EXPECT_TRUE(x >= 0 && x <= width) << name << " " << x;
      }
      for (const char* name : {"cy", "y", "y1", "y2"}) {
        const double y = node.attribute(name).as_double();
        EXPECT_TRUE(y >= 0 && y <= height) << name << " " << y;
      }
    }
    const auto png = pngOfSvg(svg);
    ASSERT_TRUE(png) << sentence(png.error());
    EXPECT_EQ(png->substr(1, 3), "PNG");
    EXPECT_GT(png->size(), 1000U);
  }
  EXPECT_FALSE(pngOfSvg("<svg"));
}

TEST(TradeReport, EveryPointOfferedIsACircleAndWhatIsNotIsNone) {
  TradeReport report = threePoints();
  report.sweep.points[1].offered = false;
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(frontSvg(report).c_str()));
  const auto circles = document.child("svg").children("circle");
  EXPECT_EQ(std::distance(circles.begin(), circles.end()), 2);
}

TEST(TradeReport, LinesOfTheErrorAreAtRoundNumbers) {
  TradeReport report = threePoints();
  const std::pair<double, const char*> worst[] = {
      {3.66, ">4 N<"}, {0.9, ">0.8 N<"}, {0.05, ">0.04 N<"}, {19.0, ">20 N<"}};
  for (const auto& [error, last] : worst) {
    for (TradePoint& point : report.sweep.points) point.errors.force_N.p95 = error;
    const std::string svg = frontSvg(report);
    EXPECT_THAT(svg, testing::HasSubstr(last)) << error;
    EXPECT_THAT(svg, testing::HasSubstr(error > 1.0   ? ">0 N<"
                                        : error > 0.1 ? ">0.0 N<"
                                                      : ">0.00 N<"));
  }
}

TEST(TradeReport, TheChosenDotIsDrawnLast) {
  TradeReport report = threePoints();
  report.chosen = report.sweep.points[0];
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(frontSvg(report).c_str()));
  std::string last;
  for (const auto& circle : document.child("svg").children("circle")) {
    last = circle.child("title").child_value();
  }
  EXPECT_EQ(last, "default");
}

TEST(TradeReport, CsvQuotesNamesAndHasAsManyCellsAsHeadings) {
  const std::string csv = tradeCsv(threePoints());
  EXPECT_THAT(csv, testing::HasSubstr("\"a<b & \"\"c\"\"\",\"a\",\"\",0,1,"));
  const auto commas = [&csv](std::size_t from) {
    const std::size_t end = csv.find('\n', from);
    return std::count(csv.begin() + static_cast<std::ptrdiff_t>(from),
                      csv.begin() + static_cast<std::ptrdiff_t>(end), ',');
  };
  EXPECT_EQ(commas(0), commas(csv.find('\n') + 1));
}

TEST(Accuracy, ReferenceIsBruteForceAndNeverCoarser) {
  SimulationSetting recorded;
  recorded.query.stopLevel = 2;
  recorded.query.contactBudget = 10;
  recorded.query.perceptualBound = 1e-3;
  recorded.solverIterations = 5;
  const auto setting = settingOfAccuracy("reference", recorded);
  ASSERT_TRUE(setting);
  EXPECT_EQ(setting->query.method, QueryMethod::BruteForce);
  EXPECT_EQ(setting->query.stopLevel, 0);
  EXPECT_EQ(setting->solverIterations, 1000U);
  EXPECT_EQ(setting->query.contactBudget, QueryOptions{}.contactBudget);
  EXPECT_EQ(setting->query.perceptualBound, 0.0);
  EXPECT_FALSE(settingOfAccuracy("perfect", recorded));
}

}  // namespace
}  // namespace palpate
