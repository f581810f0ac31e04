#pragma once
/// Random labels and cases for the tests of exchange.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "imaging/case_folder.h"
#include "imaging/exchange/label_exchange.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate::test {

/// Odd sizes, three different spacings, an oblique frame.
inline GridGeometry randomGeometry(std::mt19937& random, int smallest = 1, int largest = 6) {
  GridGeometry g;
  std::uniform_int_distribution<int> half(smallest, largest);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (auto& n : g.dims) n = 2 * half(random) + 1;
  for (double& s : g.spacing) s = (1.05 + unit(random)) * 1e-3;
  g.X_PV.linear() = Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random))
                        .normalized()
                        .toRotationMatrix();
  for (double& t : g.X_PV.translation()) t = unit(random) * 0.3;
  return g;
}

/// Values of the table and background, each voxel at random.
inline LabelGrid randomLabels(const GridGeometry& g, const LabelTable& table,
                              std::mt19937& random) {
  LabelGrid grid{g, std::vector<std::uint8_t>(g.voxelCount())};
  std::uniform_int_distribution<std::size_t> row(0, table.size());
  for (auto& label : grid.labels) {
    const std::size_t r = row(random);
    label = r == table.size() ? std::uint8_t{0} : table[r].value;
  }
  // Each at least once, so that none is left out.
  for (std::size_t r = 0; r < table.size(); ++r) grid.labels[r] = table[r].value;
  return grid;
}

inline const LabelTable& sampleTable() {
  static const LabelTable table{
      {.name = "bone", .value = 1},
      {.name = "Nervus facialis", .value = 7, .colour = {255, 0, 9}, .material = "nerve"},
      {.name = "Öhr \"links\"", .value = 200, .colour = {1, 2, 3}, .material = "skin"}};
  return table;
}

/// A case with these labels; gives the file of an export when `out` is named.
inline void makeCase(const std::filesystem::path& folder, const LabelGrid& labels,
                     const LabelTable& table) {
  ImportedScan scan;
  scan.volume.geometry = labels.geometry;
  scan.volume.int16.assign(labels.geometry.voxelCount(), 5);
  scan.volume.modality = "CT";
  scan.sourceFormat = "NRRD";
  scan.pseudonym = "Case-0A1B";
  scan.patientName = "quince^medlar";
  scan.patientId = "quince-4711";
  const auto written = writeNewCase(folder, scan);
  ASSERT_TRUE(written) << sentence(written.error());
  const auto labelled = writeCaseLabels(folder, labels, table);
  ASSERT_TRUE(labelled) << sentence(labelled.error());
}

inline Result<ExportReport> exportCase(const std::filesystem::path& folder,
                                       const std::filesystem::path& file,
                                       std::vector<std::string> names = {}, bool force = false) {
  return exportLabels({folder, file, std::move(names), force, "0"});
}

/// Of the bytes that a test damages; PALPATE_TEST_SEED for another run.
inline unsigned damageSeed() {
  const char* asked = std::getenv("PALPATE_TEST_SEED");
  const unsigned seed = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 20261126U;
  std::printf("seed %u\n", seed);
  return seed;
}

/// As writeBytes(), thousands of times: ext4 flushes a file that is cut and written again.
inline void writeAgain(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::remove(file);
  writeBytes(file, bytes);
}

/// What a test expects of a refusal, word by word.
struct Refusal {
  std::string message, field, found, expected;
};

template <class T>
void expectRefusal(const Result<T>& result, const std::filesystem::path& file,
                   const Refusal& expected) {
  ASSERT_FALSE(result) << "accepted";
  const Error& error = result.error();
  EXPECT_EQ(error.kind, ErrorKind::InputRefused);
  EXPECT_EQ(error.message, expected.message);
  EXPECT_EQ(error.file.value_or(""), file.string());
  EXPECT_EQ(error.field.value_or(""), expected.field);
  EXPECT_EQ(error.found.value_or(""), expected.found);
  EXPECT_EQ(error.expected.value_or(""), expected.expected);
  EXPECT_TRUE(error.advice);
  EXPECT_EQ(sentence(error).find("quince"), std::string::npos) << sentence(error);
}

}  // namespace palpate::test
