// fuzz_seeds <folder>: writes the seeds of every fuzzer, each into a folder of its name.

#include <bit>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#ifdef PALPATE_DICOM_SEEDS
#include "tests/fuzz/dicom_seeds.h"
#endif
#include "tests/fuzz/seed_trees.h"

namespace {

void write(const std::filesystem::path& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
}

std::string plyHeader(const char* format, const char* type) {
  std::string text =
      std::string("ply\nformat ") + format + " 1.0\ncomment seed\nelement vertex 3\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) {
    text += std::string("property ") + type + " " + name + "\n";
  }
  return text + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binaryVertices() {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes;
  for (int v = 0; v < 3; ++v) {
    const float row[6] = {1.0f * static_cast<float>(v), 2, 3, 0, 0, 1};
    bytes.append(reinterpret_cast<const char*>(row), sizeof row);
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "Usage: fuzz_seeds <folder>\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  int number = 0;
  for (const std::string& tree : palpate::seedTrees()) {
    write(folder / "tree_cache", std::to_string(number++) + ".tree", tree);
  }
  write(folder / "shell_file", "ascii.ply",
        plyHeader("ascii", "float") + "0 0 0 1 0 0\n1 2.5 3e0 0 -1 0\r\n4 5 6 0 0 2\n3 0 1 2\n");
  write(folder / "shell_file", "binary.ply",
        plyHeader("binary_little_endian", "float32") + binaryVertices() +
            std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13));
  write(folder / "shell_file", "other_first.ply",
        "ply\nformat ascii 1.0\nelement camera 1\nproperty int id\nelement vertex 1\n"
        "property double x\nproperty double y\nproperty double z\nproperty uchar red\n"
        "property double nx\nproperty double ny\nproperty double nz\nend_header\n7\n"
        "1 2 3 255 0 1 0\n");
  const std::string heading = "step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz\n";
  write(folder / "trajectory_file", "two.csv",
        heading + "0,1,0,0,10,0,1,0,-2.5,0,0,1,3\n1,0,-1,0,1e1,1,0,0,2,0,0,1,.5\n");
  write(folder / "trajectory_file", "rounded.csv",
        heading + " 5 , 0.707107,-0.707107,0,0, 0.707107,0.707107,0,0, 0,0,1,0\r\n\n");
#ifdef PALPATE_DICOM_SEEDS
  for (const auto& [name, bytes] : palpate::dicomSeeds()) write(folder / "dicom", name, bytes);
#endif
  return 0;
}
