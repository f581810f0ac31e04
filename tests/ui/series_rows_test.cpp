/// What `palpate series --json` says, word by word as the window's list shows it.

#include "app/series_rows.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using nlohmann::json;

/// As command_series.cpp writes an importable series with --names and --thumbnails.
json head() {
  return {{"uid", "1.2.3"},
          {"modality", "CT"},
          {"description", "Head 1.0"},
          {"study", 1},
          {"files", 82},
          {"bytes", 43'210'000},
          {"importable", true},
          {"reason", nullptr},
          {"repair", nullptr},
          {"dims", {256, 256, 108}},
          {"spacing_mm", {0.957, 0.957, 1.5}},
          {"patient_name", "Doe^Peter"},
          {"patient_id", "7"},
          {"study_date", "20260131"},
          {"thumbnail", {{"width", 2}, {"height", 1}, {"grey", "00ff"}}}};
}

std::vector<ui::SeriesRow> rowsOf(const std::vector<json>& series) {
  return seriesRows(json{{"series", series}, {"skipped_files", 0}}.dump());
}

ui::SeriesRow rowOf(const json& series) {
  const auto rows = rowsOf({series});
  EXPECT_EQ(rows.size(), 1U);
  return rows.empty() ? ui::SeriesRow{} : rows[0];
}

json with(const char* key, const json& value) {
  json series = head();
  series[key] = value;
  return series;
}

TEST(SeriesRows, SayWhatASeriesIs) {
  const ui::SeriesRow row = rowOf(head());
  EXPECT_EQ(row.uid, "1.2.3");
  EXPECT_EQ(row.title, "CT \xc2\xb7 Head 1.0");
  EXPECT_EQ(row.grid, "256 \xc3\x97 256 \xc3\x97 108");
  EXPECT_EQ(row.spacing, "0.96 \xc3\x97 0.96 \xc3\x97 1.50 mm");
  EXPECT_EQ(row.size, "82 files \xc2\xb7 43 MB");
  EXPECT_EQ(row.study, "Doe Peter \xc2\xb7 2026-01-31");
  EXPECT_TRUE(row.importable);
  EXPECT_FALSE(row.repairable);
  EXPECT_EQ(row.reason, "");
  EXPECT_EQ(row.picture.width, 2);
  EXPECT_EQ(row.picture.grey, (std::vector<std::uint8_t>{0, 255}));
}

TEST(SeriesRows, SizesAreInTheUnitThatReadsBest) {
  for (const auto& [files, bytes, words] :
       {std::tuple{1, 512, "1 file \xc2\xb7 1 kB"}, std::tuple{2, 39'000, "2 files \xc2\xb7 39 kB"},
        std::tuple{1, 1'240'000, "1 file \xc2\xb7 1.2 MB"},
        std::tuple{9, 9'990'000, "9 files \xc2\xb7 10.0 MB"},
        std::tuple{400, 210'400'000, "400 files \xc2\xb7 210 MB"}}) {
    json series = with("files", files);
    series["bytes"] = bytes;
    EXPECT_EQ(rowOf(series).size, words);
  }
}

TEST(SeriesRows, WithoutADescriptionTheModalityIsTheTitle) {
  EXPECT_EQ(rowOf(with("description", "")).title, "CT series");
  json series = with("description", "");
  series["modality"] = "";
  EXPECT_EQ(rowOf(series).title, "Series");
  series["description"] = "NIfTI volume";
  EXPECT_EQ(rowOf(series).title, "NIfTI volume");
}

TEST(SeriesRows, NamesReadAsPeopleWriteThem) {
  EXPECT_EQ(rowOf(with("patient_name",
                       "Yamada^Tarou=\xe5\xb1\xb1\xe7\x94\xb0^\xe5\xa4\xaa\xe9\x83\x8e"
                       "=\xe3\x82\x84\xe3\x81\xbe\xe3\x81\xa0^\xe3\x81\x9f"))
                .study,
            "Yamada Tarou \xc2\xb7 \xe5\xb1\xb1\xe7\x94\xb0 \xe5\xa4\xaa\xe9\x83\x8e \xc2\xb7 "
            "\xe3\x82\x84\xe3\x81\xbe\xe3\x81\xa0 \xe3\x81\x9f \xc2\xb7 2026-01-31");
  // Empty parts leave no marks: "family^given^middle^prefix^suffix", "latin=ideographic=phonetic".
  EXPECT_EQ(rowOf(with("patient_name", "Doe^Peter^^^")).study, "Doe Peter \xc2\xb7 2026-01-31");
  EXPECT_EQ(rowOf(with("patient_name", "=\xe5\xb1\xb1\xe7\x94\xb0=")).study,
            "\xe5\xb1\xb1\xe7\x94\xb0 \xc2\xb7 2026-01-31");
}

TEST(SeriesRows, AStudyWithoutNameHasANumberAndWithoutDateNone) {
  json series = with("patient_name", "");
  series["study"] = 3;
  EXPECT_EQ(rowOf(series).study, "Study 3 \xc2\xb7 2026-01-31");
  series["study_date"] = "";
  EXPECT_EQ(rowOf(series).study, "Study 3");
  EXPECT_EQ(rowOf(with("study_date", "2026")).study, "Doe Peter \xc2\xb7 2026");
}

TEST(SeriesRows, RowsOfOneStudyCarryItsNumber) {
  json other = head();  // the same patient and day, but another study
  other["study"] = 2;
  const auto rows = rowsOf({head(), head(), other});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].studyNumber, rows[1].studyNumber);
  EXPECT_NE(rows[1].studyNumber, rows[2].studyNumber);
}

TEST(SeriesRows, AReasonIsOfTheWindowAndNotOfTheCommandLine) {
  json series = with("importable", false);
  series["reason"] =
      "its slices are 1.08 to 6.99 mm apart (uneven spacing or missing slices); imports with "
      "--repair spacing";
  series["repair"] = "spacing";
  series["dims"] = nullptr;
  series["spacing_mm"] = nullptr;
  const ui::SeriesRow row = rowOf(series);
  EXPECT_FALSE(row.importable);
  EXPECT_TRUE(row.repairable);
  EXPECT_EQ(row.reason, "Its slices are 1.08 to 6.99 mm apart (uneven spacing or missing slices)");
  EXPECT_EQ(row.grid + row.spacing, "");
}

TEST(SeriesRows, AdviceOfTheWindowNamesNoCommand) {
  EXPECT_EQ(
      withoutCommandLine("Choose another series of the study; `palpate series PATH` lists them."),
      "Choose another series of the study.");
  EXPECT_EQ(withoutCommandLine("Check the path; and its spelling."),
            "Check the path; and its spelling.");
  EXPECT_EQ(withoutCommandLine(""), "");
}

TEST(SeriesRows, APictureThatIsNotWhatItSaysIsNoPicture) {
  for (const json& thumbnail :
       {json(nullptr), json("00ff"), json{{"width", 2}, {"height", 2}, {"grey", "00ff"}},
        json{{"width", -2}, {"height", -1}, {"grey", "00ff"}},
        json{{"width", 100'000}, {"height", 100'000}, {"grey", ""}}}) {
    EXPECT_EQ(rowOf(with("thumbnail", thumbnail)).picture.width, 0) << thumbnail;
  }
}

TEST(SeriesRows, WhatIsNoListOfSeriesHasNoRows) {
  for (const char* text : {"", "{", "[]", "{\"error\":{}}", "{\"series\":[]}"}) {
    EXPECT_TRUE(seriesRows(text).empty()) << text;
  }
}

}  // namespace
}  // namespace palpate
