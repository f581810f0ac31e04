#include "core/collision/shell_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace palpate {
namespace {

const std::string kVertex =
    "property float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\n";

std::string ascii(const std::string& count, const std::string& rows,
                  const std::string& properties = kVertex) {
  return "ply\nformat ascii 1.0\ncomment made by a test\nelement vertex " + count + "\n" +
         properties + "element face 0\nproperty list uchar int vertex_indices\nend_header\n" + rows;
}

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

std::string refusal(const std::string& bytes) {
  const auto shell = parseShell(bytes, "tool.ply");
  if (shell) return "accepted";
  EXPECT_EQ(shell.error().kind, ErrorKind::InputRefused);
  EXPECT_EQ(shell.error().file, "tool.ply");
  return sentence(shell.error());
}

TEST(ShellFile, ReadsAsciiPointsInMillimetres) {
  const auto shell = parseShell(ascii("2", "1 2 3 0 0 2\r\n -4e0\t5 6 1 0 0\n"), "tool.ply");
  ASSERT_TRUE(shell) << sentence(shell.error());
  ASSERT_EQ(shell->size(), 2U);
  EXPECT_LT((shell->points_T()[1] - Eigen::Vector3d(-4e-3, 5e-3, 6e-3)).norm(), 1e-18);
  EXPECT_EQ(shell->normals_T()[0], Eigen::Vector3d::UnitZ());
}

// Squares of the longest overflow, of the shortest underflow.
TEST(ShellFile, NormalsMayHaveAnyLength) {
  const std::string doubles =
      "property double x\nproperty double y\nproperty double z\n"
      "property double nx\nproperty double ny\nproperty double nz\n";
  for (const std::string exponent :
       {"e-323", "e-320", "e-161", "e-30", "e0", "e30", "e200", "e307"}) {
    const auto shell = parseShell(
        ascii("1", "0 0 0 -4" + exponent + " 0 4" + exponent + "\n", doubles), "tool.ply");
    ASSERT_TRUE(shell) << sentence(shell.error());
    EXPECT_LT((shell->normals_T()[0] - Eigen::Vector3d(-1, 0, 1).normalized()).norm(), 1e-15)
        << exponent;
  }
}

TEST(ShellFile, ReadsBinaryInAnyOrderOfPropertiesAmongOthers) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement camera 2\nproperty short a\nproperty double "
      "b\n"
      "element vertex 3\nproperty uchar red\nproperty double nz\nproperty float ny\n"
      "property float nx\nproperty float x\nproperty double y\nproperty int z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    append(bytes, std::int16_t{5});
    append(bytes, 1.25);
  }
  for (int i = 0; i < 3; ++i) {
    append(bytes, std::uint8_t{200});
    append(bytes, 1.0);
    append(bytes, 0.0F);
    append(bytes, 0.0F);
    append(bytes, 10.0F + static_cast<float>(i));
    append(bytes, -0.5);
    append(bytes, std::int32_t{7});
  }
  append(bytes, std::uint8_t{3});
  const auto shell = parseShell(bytes, "tool.ply");
  ASSERT_TRUE(shell) << sentence(shell.error());
  ASSERT_EQ(shell->size(), 3U);
  EXPECT_LT((shell->points_T()[2] - Eigen::Vector3d(12e-3, -0.5e-3, 7e-3)).norm(), 1e-18);
  EXPECT_EQ(shell->normals_T()[2], Eigen::Vector3d::UnitZ());

  EXPECT_NE(refusal(bytes.substr(0, bytes.size() - 20)).find("The PLY file is cut short."),
            std::string::npos);
}

TEST(ShellFile, BadFilesAreRefusedByLineOrVertex) {
  EXPECT_NE(refusal("").find("The file is not a PLY file."), std::string::npos);
  EXPECT_NE(refusal("solid stl\n").find("The file is not a PLY file."), std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\n").find("The header of the PLY file does not end."),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat binary_big_endian 1.0\n")
                .find("Line 2 of the PLY file: the format is not one that is read."),
            std::string::npos);
  EXPECT_NE(refusal("ply\nformat ascii 1.0\nend_header\n").find("no element 'vertex'"),
            std::string::npos);
  EXPECT_NE(
      refusal("ply\nend_header\n").find("Line 2 of the PLY file: the header names no format."),
      std::string::npos);
  EXPECT_NE(refusal(ascii("1", "1 2 3\n", "property float x\nproperty float y\nproperty float z\n"))
                .find("The vertices of the PLY file lack a property."),
            std::string::npos);
  EXPECT_NE(refusal(ascii("1", "", "property list uchar int x\n")).find("a list in or before"),
            std::string::npos);
  EXPECT_NE(refusal(ascii("many", "")).find("Line 4 of the PLY file: the element has no name"),
            std::string::npos);
  EXPECT_NE(refusal(ascii("1", "", "property colour x\n")).find("the property's type is unknown"),
            std::string::npos);
  EXPECT_NE(refusal(ascii("2", "1 2 3 0 0 1\n")).find("The PLY file is cut short."),
            std::string::npos);
  EXPECT_NE(refusal(ascii("0", "")).find("The point shell has no points."), std::string::npos);
  EXPECT_NE(refusal(ascii("18446744073709551615", "1 2 3 0 0 1\n")).find("cut short"),
            std::string::npos);
  // The header has 13 lines.
  EXPECT_NE(refusal(ascii("2", "1 2 3 0 0 1\n1 2 x 0 0 1\n"))
                .find("Line 15 of the PLY file: a field is not a number."),
            std::string::npos);
  EXPECT_NE(refusal(ascii("1", "1 2 3 0 0\n")).find("Line 14 of the PLY file"), std::string::npos);
  EXPECT_NE(refusal(ascii("1", "1 2 3 0 0 1 9\n")).find("there are more fields than properties"),
            std::string::npos);
  EXPECT_NE(refusal(ascii("1", "1 2 nan 0 0 1\n"))
                .find("Line 14 of the PLY file: a number is not finite."),
            std::string::npos);
  EXPECT_NE(refusal(ascii("1", "1 2 3 0 0 0\n"))
                .find("Line 14 of the PLY file: the normal has no direction."),
            std::string::npos);
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\n" + kVertex + "end_header\n";
  for (int i = 0; i < 11; ++i) append(binary, 1.0F);
  append(binary, std::numeric_limits<float>::infinity());
  EXPECT_NE(refusal(binary).find("Vertex 1 of the PLY file: a number is not finite."),
            std::string::npos);
}

// A huge count must be refused by arithmetic, not by trying.
TEST(ShellFile, ACountThatOverflowsIsCutShort) {
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement big 9223372036854775807\n"
      "property double a\nelement vertex 768614336404564651\n" +
      kVertex + "end_header\n0123456789";
  EXPECT_NE(refusal(binary).find("cut short"), std::string::npos);
}

TEST(ShellFile, AMissingFileIsRefused) {
  const auto shell = readShellFile("/nowhere/tool.ply");
  ASSERT_FALSE(shell);
  EXPECT_EQ(shell.error().message, "There is no such file.");
}

}  // namespace
}  // namespace palpate
