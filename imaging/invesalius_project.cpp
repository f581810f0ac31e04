#include "imaging/invesalius_project.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "imaging/archive.h"
#include "imaging/volume.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMaxPlistBytes = 1U << 20U;  // real ones are below 10 kB
constexpr std::int32_t kMaxSide = 8192;
constexpr int kMaxMasks = 1000;  // real projects have a handful; each costs a look at the archive
constexpr const char* kMain = "main.plist";

Result<GridGeometry> geometryOf(const pugi::xml_node& root, const fs::path& file) {
  const auto shape = plistNumbers(plistValue(plistValue(root, "matrix"), "shape"));
  const auto spacing = plistNumbers(plistValue(root, "spacing"));
  const bool shapeFits = shape.size() == 3 && std::all_of(shape.begin(), shape.end(), [](double n) {
                           return n >= 1.0 && n <= kMaxSide && n == std::trunc(n);
                         });
  if (!shapeFits || shape[0] * shape[1] * shape[2] > static_cast<double>(kMaxVoxels)) {
    return fail(
        wrongPlistField(file, kMain, "matrix, shape", "another shape", "three counts of voxels"));
  }
  const bool spacingFits =
      spacing.size() == 3 && std::all_of(spacing.begin(), spacing.end(), [](double s) {
        return std::isfinite(s) && s > 0.0 && s < 1000.0;
      });
  if (!spacingFits) {
    return fail(wrongPlistField(file, kMain, "spacing", "another spacing", "three lengths"));
  }
  // shape is slices, rows, columns; spacing is columns, rows, slices.
  GridGeometry geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    geometry.dims[axis] = static_cast<std::int32_t>(shape[2 - axis]);
    const auto a = static_cast<Eigen::Index>(axis);
    geometry.spacing[a] = spacing[axis] * 1e-3;
    geometry.X_PV.translation()[a] = -0.5 * (geometry.dims[axis] - 1) * geometry.spacing[a];
  }
  return geometry;
}

Result<std::vector<std::string>> maskFilesOf(const pugi::xml_node& root, const fs::path& file) {
  std::map<int, std::string> byNumber;  // "10" after "2"
  for (const pugi::xml_node key : plistValue(root, "masks").children("key")) {
    const std::string part = fs::path(key.next_sibling().child_value()).filename().string();
    const int number = key.text().as_int(-1);
    if (part.empty() || number < 0) {
      return fail(wrongPlistField(file, kMain, "masks", "an entry without number or file",
                                  "numbers and the names of their files"));
    }
    byNumber[number] = part;
    if (byNumber.size() > kMaxMasks) {
      return fail(wrongPlistField(file, kMain, "masks",
                                  "more than " + std::to_string(kMaxMasks) + " masks",
                                  "at most " + std::to_string(kMaxMasks)));
    }
  }
  std::vector<std::string> files;
  for (auto& [number, part] : byNumber) files.push_back(std::move(part));
  return files;
}

}  // namespace

Error wrongPlistField(const fs::path& project, const std::string& part, const char* field,
                      std::string found, std::string wanted) {
  return inputRefused("The InVesalius project cannot be read.")
      .inFile(project.string())
      .inField(part + ": " + field)
      .butFound(found.empty() ? "nothing" : std::move(found))
      .wants(std::move(wanted))
      .advise("Open the project in InVesalius and save it again.");
}

pugi::xml_node plistValue(const pugi::xml_node& dict, const char* name) {
  for (const pugi::xml_node key : dict.children("key")) {
    if (std::strcmp(key.child_value(), name) == 0) return key.next_sibling();
  }
  return {};
}

std::vector<double> plistNumbers(const pugi::xml_node& array) {
  std::vector<double> numbers;
  for (const pugi::xml_node item : array.children()) numbers.push_back(item.text().as_double());
  return numbers;
}

Result<pugi::xml_document> readPlist(const fs::path& project, const std::string& part) {
  const auto bytes = readArchiveMember(project, part, kMaxPlistBytes);
  if (!bytes) return fail(bytes.error());
  pugi::xml_document document;
  if (!document.load_buffer(bytes->data(), bytes->size())) {
    return fail(wrongPlistField(project, part, "whole file", "text that is not XML",
                                "an XML property list"));
  }
  return document;
}

Result<InvesaliusProject> openInvesaliusProject(const fs::path& file) {
  const auto document = readPlist(file, kMain);
  if (!document) return fail(document.error());
  const pugi::xml_node root = document->child("plist").child("dict");
  const pugi::xml_node matrix = plistValue(root, "matrix");
  InvesaliusProject project;
  project.modality = plistValue(root, "modality").child_value();
  if (project.modality == "MRI") project.modality = "MR";
  project.matrixFile = fs::path(plistValue(matrix, "filename").child_value()).filename().string();
  if (project.matrixFile.empty()) {
    return fail(wrongPlistField(file, kMain, "matrix, filename", "", "the name of the voxel file"));
  }
  const std::string type = plistValue(matrix, "dtype").child_value();
  if (type != "int16") return fail(wrongPlistField(file, kMain, "matrix, dtype", type, "int16"));
  const int orientation = plistValue(root, "orientation").text().as_int(1);
  if (orientation != 1) {
    return fail(
        wrongPlistField(file, kMain, "orientation", std::to_string(orientation), "1 (axial)"));
  }
  const auto geometry = geometryOf(root, file);
  if (!geometry) return fail(geometry.error());
  project.geometry = *geometry;
  auto masks = maskFilesOf(root, file);
  if (!masks) return fail(masks.error());
  project.maskFiles = std::move(*masks);
  return project;
}

Result<std::vector<char>> readExactly(const fs::path& project, const std::string& part,
                                      std::uint64_t bytes, const char* what) {
  auto found = readArchiveMember(project, part, bytes);
  if (!found || found->size() == bytes) return found;
  return fail(inputRefused(std::string("The ") + what + " of the InVesalius project are cut short.")
                  .inFile(project.string())
                  .inField(part)
                  .butFound(std::to_string(found->size()) + " bytes")
                  .wants(std::to_string(bytes) + " bytes")
                  .advise("Copy the project again from where it came."));
}

}  // namespace palpate
