#include "core/scene/anatomy.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/scene/material.h"
#include "tests/core/scene/temporary_folder.h"

namespace palpate {
namespace {

TEST(Anatomies, TheProgramsOwnNameMaterialsThatAreThere) {
  const std::filesystem::path datasets = PALPATE_DATASETS;
  const auto anatomies = readAnatomies(datasets / "labels.toml");
  const auto materials = readMaterials(datasets / "materials.toml");
  ASSERT_TRUE(anatomies) << sentence(anatomies.error());
  ASSERT_TRUE(materials);
  EXPECT_GE(anatomies->size(), 10U);
  for (const Anatomy& anatomy : *anatomies) {
    EXPECT_TRUE(std::any_of(materials->begin(), materials->end(), [&](const Material& m) {
      return m.name == anatomy.material;
    })) << anatomy.name;
  }
}

TEST(Anatomies, BadRowsAreRefusedByName) {
  TemporaryFolder folder;
  const std::string row = "[[label]]\nname = \"bone\"\ntitle = \"Bone\"\nmaterial = \"bone\"\n";
  const auto message = [&folder](const std::string& text) {
    const auto read = readAnatomies(folder.write("l.toml", text));
    return read ? std::string("accepted")
                : read.error().message + "|" + read.error().field.value_or("");
  };
  EXPECT_EQ(message(row), "accepted");
  EXPECT_EQ(message(row + row), "Two labels have one name.|label[1].name");
  EXPECT_EQ(message(row + "size = 3\n"), "The file has a key that is not known.|label[0].size");
  EXPECT_EQ(message("[[label]]\nname = \"x\"\n"),
            "The file lacks a key that it must have.|label[0].title");
}

TEST(Anatomies, OnlyNewRowsAreDressed) {
  const std::vector<Anatomy> anatomies{{"mandible", "Mandible", {1, 2, 3}, "bone"},
                                       {"facial-nerve", "Facial nerve", {4, 5, 6}, "nerve"}};
  const LabelTable before{{"mandible", 1, {9, 9, 9}, "tooth"}};
  LabelTable after = before;
  after.push_back({"facial-nerve", 2, {7, 7, 7}, "bone"});
  after.push_back({"something", 3, {8, 8, 8}, "bone"});
  dressNewRows(before, after, anatomies);
  EXPECT_EQ(after[0].material, "tooth");
  EXPECT_EQ(after[1].material, "nerve");
  EXPECT_EQ(after[1].colour, (std::array<std::uint8_t, 3>{4, 5, 6}));
  EXPECT_EQ(after[2].material, "bone");
}

}  // namespace
}  // namespace palpate
