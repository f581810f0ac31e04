#include "core/scene/instrument.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scene/instrument_mesh.h"
#include "core/scene/material.h"
#include "tests/core/scene/temporary_folder.h"

namespace palpate {
namespace {

constexpr double kPi = std::numbers::pi;

CrossSection section(double z, double a, double b, double twist = 0.0) {
  return {{0, 0, z}, {a, b}, twist};
}

/// Area of the polygon of n vertices inscribed in an ellipse.
double polygonArea(double a, double b, std::uint32_t n) {
  return 0.5 * n * std::sin(2.0 * kPi / n) * a * b;
}

TEST(InstrumentMesh, PrismVolumeIsTheClosedForm) {
  for (const std::uint32_t n : {6U, 24U, 101U}) {
    const auto mesh = sweepSections({section(0, 3e-3, 2e-3), section(0.05, 3e-3, 2e-3)}, n);
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(isClosed(*mesh));
    const double expected = polygonArea(3e-3, 2e-3, n) * 0.05;
    EXPECT_NEAR(signedVolume(*mesh), expected, 1e-12 * expected);
  }
}

TEST(InstrumentMesh, ConeAndFrustumVolumesAreTheClosedForm) {
  const auto cone = sweepSections({section(0, 0, 0), section(0.02, 4e-3, 4e-3)}, 32);
  ASSERT_TRUE(cone);
  EXPECT_TRUE(isClosed(*cone));
  const double coneVolume = polygonArea(4e-3, 4e-3, 32) * 0.02 / 3.0;
  EXPECT_NEAR(signedVolume(*cone), coneVolume, 1e-12 * coneVolume);

  const auto frustum = sweepSections({section(0, 1e-3, 1e-3), section(0.01, 3e-3, 3e-3)}, 32);
  ASSERT_TRUE(frustum);
  const double frustumVolume = polygonArea(1, 1, 32) * 1e-6 * 0.01 * (1.0 + 3.0 + 9.0) / 3.0;
  EXPECT_NEAR(signedVolume(*frustum), frustumVolume, 1e-12 * frustumVolume);
}

TEST(InstrumentMesh, SphereVolumeConvergesToTheClosedForm) {
  const double r = 3e-3;
  double last = 1.0;
  for (const int rings : {8, 16, 32, 64}) {
    std::vector<CrossSection> sections;
    for (int k = 0; k <= rings; ++k) {
      const double angle = kPi * k / rings;
      const bool pole = k == 0 || k == rings;
      const double radius = pole ? 0.0 : r * std::sin(angle);
      sections.push_back(section(r - r * std::cos(angle), radius, radius));
    }
    const auto mesh = sweepSections(sections, static_cast<std::uint32_t>(4 * rings));
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(isClosed(*mesh));
    const double exact = 4.0 / 3.0 * kPi * r * r * r;
    const double error = std::abs(signedVolume(*mesh) - exact) / exact;
    EXPECT_LT(error, 0.3 * last);  // second order: a quarter each time
    last = error;
  }
  EXPECT_LT(last, 2e-3);
}

TEST(InstrumentMesh, BendKeepsTheVolumeOfTheTube) {
  // Pappus: a tube along an arc has the volume of its section times the length of the arc.
  std::vector<CrossSection> sections;
  const double bend = 0.02;
  constexpr int kSteps = 200;
  for (int k = 0; k <= kSteps; ++k) {
    const double angle = 0.5 * kPi * k / kSteps;
    sections.push_back(
        {{bend - bend * std::cos(angle), 0, bend * std::sin(angle)}, {2e-3, 1e-3}, 0.0});
  }
  const auto mesh = sweepSections(sections, 48);
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(isClosed(*mesh));
  const double expected = polygonArea(2e-3, 1e-3, 48) * bend * 0.5 * kPi;
  EXPECT_NEAR(signedVolume(*mesh), expected, 1e-4 * expected);
}

TEST(InstrumentMesh, TwistTurnsTheSection) {
  const auto mesh =
      sweepSections({section(0, 3e-3, 1e-3, 0.5 * kPi), section(0.01, 3e-3, 1e-3, 0.5 * kPi)}, 32);
  ASSERT_TRUE(mesh);
  double widestY = 0.0, widestX = 0.0;
  for (const auto& v : mesh->vertices) {
    widestX = std::max(widestX, v.x());
    widestY = std::max(widestY, v.y());
  }
  EXPECT_NEAR(widestY, 3e-3, 1e-15);
  EXPECT_NEAR(widestX, 1e-3, 1e-15);
}

TEST(InstrumentMesh, WhatCannotBeSweptIsRefusedBySection) {
  const auto message = [](const std::vector<CrossSection>& sections) {
    const auto mesh = sweepSections(sections, 12);
    return mesh ? std::string("accepted") : sentence(mesh.error());
  };
  EXPECT_EQ(message({section(0, 1e-3, 1e-3)}),
            "An instrument needs at least two sections. Field: section[1]. "
            "Expected: two sections or more.");
  EXPECT_EQ(message({section(0, 1e-3, 1e-3), section(0.01, 0, 1e-3)}),
            "A section has a half-axis that is not positive. Field: section[1]. "
            "Expected: positive half-axes, or both zero at an end.");
  EXPECT_EQ(message({section(0, 1e-3, 1e-3), section(0.01, 0, 0), section(0.02, 1e-3, 1e-3)}),
            "A section has a half-axis that is not positive. Field: section[1]. "
            "Expected: positive half-axes, or both zero at an end.");
  EXPECT_EQ(message({section(0, 1e-3, 1e-3), section(0, 1e-3, 1e-3)}),
            "Two sections lie in one place. Field: section[1]. "
            "Expected: at least 0.0001 mm from the section before.");
  EXPECT_EQ(message({section(0, 1e-3, 1e-3), section(0.02, 1e-3, 1e-3), section(0.01, 1e-3, 1e-3)}),
            "The path folds back on itself. Field: section[1]. "
            "Expected: a bend of less than 90 degrees.");
}

TEST(Instruments, EveryInstrumentOfTheProgramIsClosedAndStartsAtItsTip) {
  const auto instruments = readInstruments(std::filesystem::path(PALPATE_DATASETS) / "instruments");
  ASSERT_TRUE(instruments) << sentence(instruments.error());
  ASSERT_GE(instruments->size(), 4U);
  for (const Instrument& instrument : *instruments) {
    SCOPED_TRACE(instrument.name);
    EXPECT_TRUE(isClosed(instrument.mesh_T));
    EXPECT_GT(signedVolume(instrument.mesh_T), 0.0);
    EXPECT_FALSE(instrument.title.empty());
    EXPECT_EQ(instrument.description.back(), '.');
    EXPECT_NE(instrument.source.find("Apache-2.0"), std::string::npos);
    double tip = 1.0, lowest = 1.0, highest = -1.0;
    for (const auto& v : instrument.mesh_T.vertices) {
      tip = std::min(tip, v.norm());
      lowest = std::min(lowest, v.z());
      highest = std::max(highest, v.z());
    }
    EXPECT_LT(tip, 1e-6);        // a vertex (or the centre of the flat end) is the origin
    EXPECT_GT(lowest, -1.0e-3);  // nothing of note lies beyond the tip
    EXPECT_GT(highest, 0.05);    // and the shaft runs along +z
    EXPECT_LT(highest, 0.12);
    // What a hand holds: grams, not kilograms (haptics_facts: at most 100 g stays well damped).
    EXPECT_GT(instrument.massProperties.mass, 1e-3);
    EXPECT_LT(instrument.massProperties.mass, 0.1);
  }
}

TEST(Instruments, TheBallBurrHasASixMillimetreBall) {
  const auto burr =
      readInstrument(std::filesystem::path(PALPATE_DATASETS) / "instruments/ball-burr.toml");
  ASSERT_TRUE(burr) << sentence(burr.error());
  EXPECT_EQ(burr->name, "ball-burr");
  double widest = 0.0;
  for (const auto& v : burr->mesh_T.vertices) {
    if (v.z() < 6e-3) widest = std::max(widest, std::hypot(v.x(), v.y()));
    if (v.z() < 5.5e-3) {
      EXPECT_NEAR((v - Eigen::Vector3d(0, 0, 3e-3)).norm(), 3e-3, 2e-6);
    }
  }
  EXPECT_NEAR(widest, 3e-3, 3e-5);
}

TEST(Instruments, BadFilesAreRefusedByFileAndField) {
  TemporaryFolder folder;
  const auto message = [&folder](const std::string& text) {
    folder.write("bad.toml", text);
    const auto instrument = readInstrument(folder / "bad.toml");
    if (instrument) return std::string("accepted");
    std::string all = sentence(instrument.error());
    const std::string path = (folder / "bad.toml").string();
    const auto at = all.find(path);
    EXPECT_NE(at, std::string::npos) << all;
    return at == std::string::npos ? all : all.replace(at, path.size(), "bad.toml");
  };
  const std::string head = "title = \"T\"\ndescription = \"D.\"\nsource = \"S\"\n";
  EXPECT_EQ(message(head + "density_kg_per_m3 = 7900\n"),
            "The file lacks a key that it must have. File: bad.toml. Field: section. "
            "Found: nothing. Expected: section.");
  EXPECT_EQ(message(head + "density_kg_per_m3 = -1\n[[section]]\n"),
            "A number is out of range. File: bad.toml. Field: density_kg_per_m3. Found: -1. "
            "Expected: 100 to 25000.");
  EXPECT_EQ(message(head + "density_kg_per_m3 = 7900\n[[section]]\nat_mm = [0, 0]\n"),
            "An array has the wrong length. File: bad.toml. Field: section[0].at_mm. Found: 2. "
            "Expected: an array of 3 numbers.");
  EXPECT_EQ(message(head + "density_kg_per_m3 = 7900\n[[section]]\nat_mm = [0, 0, 0]\n"
                           "half_axes_mm = [1, 1]\nradius = 2\n"),
            "The file has a key that is not known. File: bad.toml. Field: section[0].radius. "
            "Found: radius. Expected: one of: at_mm, half_axes_mm, twist_deg. "
            "Remove it or correct its spelling.");
  EXPECT_EQ(message(head + "density_kg_per_m3 = 7900\n[[section]]\nat_mm = [0, 0, 0]\n"
                           "half_axes_mm = [1, 1]\n"),
            "An instrument needs at least two sections. File: bad.toml. Field: section[1]. "
            "Expected: two sections or more.");
}

TEST(Materials, TheProgramsOwnAreReadAndNameTheirSources) {
  const auto materials = readMaterials(std::filesystem::path(PALPATE_DATASETS) / "materials.toml");
  ASSERT_TRUE(materials) << sentence(materials.error());
  bool bone = false;
  for (const Material& material : *materials) {
    EXPECT_FALSE(material.source.empty()) << material.name;
    bone = bone || material.name == "bone";
  }
  EXPECT_TRUE(bone);
}

TEST(Materials, BadRowsAreRefusedByName) {
  TemporaryFolder folder;
  const std::string row =
      "[[material]]\nname = \"bone\"\nstiffness_N_per_mm = 2\nfriction = 0.2\n"
      "density_kg_per_m3 = 1900\nsource = \"us\"\n";
  const auto message = [&folder](const std::string& text) {
    const auto materials = readMaterials(folder.write("m.toml", text));
    return materials ? std::string("accepted")
                     : materials.error().message + "|" + materials.error().field.value_or("") +
                           "|" + materials.error().found.value_or("");
  };
  EXPECT_EQ(message(row), "accepted");
  EXPECT_EQ(message(row + row), "Two materials have one name.|material|bone");
  EXPECT_EQ(message(row + "restitution = 1.5\n"),
            "A number is out of range.|material[0].restitution|1.5");
  EXPECT_EQ(message(row + "stiffness = 1\n"),
            "The file has a key that is not known.|material[0].stiffness|stiffness");
  EXPECT_EQ(message(row + "[[material.with]]\nname = \"steel\"\nfriction = 0.1\n"), "accepted");
  EXPECT_EQ(message(row + "[[material.with]]\nname = \"wood\"\nfriction = 0.1\n"),
            "A pair names a material that is not in the file.|material|bone with wood");
  EXPECT_EQ(message(row + "[[material.with]]\nname = \"bone\"\n"),
            "The file lacks a key that it must have.|material[0].with[0].friction|nothing");
}

TEST(Materials, PairsAreToldOrFollowTheRuleInEitherOrder) {
  std::vector<Material> m(3);
  m[0].name = "a";
  m[0].friction = 0.4;
  m[0].restitution = 0.3;
  m[1].name = "b";
  m[1].friction = 0.1;
  m[1].restitution = 0.5;
  m[2].name = "c";
  m[2].friction = 0.9;
  m[0].with = {{"c", 0.7, 0.2}, {"a", 0.6, 0.1}};
  m[1].with = {{kSteel, 0.15, 0.05}};
  const auto expectPair = [&m](const char* x, const char* y, double friction, double restitution) {
    for (const auto& pair : {pairOf(m, x, y), pairOf(m, y, x)}) {
      EXPECT_NEAR(pair.friction, friction, 1e-15) << x << " with " << y;
      EXPECT_NEAR(pair.restitution, restitution, 1e-15) << x << " with " << y;
    }
  };
  expectPair("a", kSteel, 0.4, 0.3);    // its own: with steel
  expectPair("b", kSteel, 0.15, 0.05);  // told
  expectPair("a", "c", 0.7, 0.2);       // told by one of them
  expectPair("a", "a", 0.6, 0.1);
  expectPair("a", "b", 0.2, 0.3);  // the rule: √(0.4·0.1), the lower
  expectPair("c", "c", 0.9, 0.0);
}

}  // namespace
}  // namespace palpate
