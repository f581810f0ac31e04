#pragma once
/// What main.plist of an InVesalius project says, and the property lists beside it.

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/grid_geometry.h"

namespace palpate {

struct InvesaliusProject {
  GridGeometry geometry;  ///< At most kMaxVoxels voxels, centred on the origin.
  std::string modality;
  std::string matrixFile;
  std::vector<std::string> maskFiles;  ///< Property lists, in the order of the masks' numbers.
};

/// Refuses a project whose fields are not what the format says, by file and field. Names of parts
/// are the last of their path.
[[nodiscard]] Result<InvesaliusProject> openInvesaliusProject(const std::filesystem::path& file);

/// A property list of the project, its root dictionary within.
[[nodiscard]] Result<pugi::xml_document> readPlist(const std::filesystem::path& project,
                                                   const std::string& part);
/// The element after `<key>name</key>` in a dictionary; null when there is none.
[[nodiscard]] pugi::xml_node plistValue(const pugi::xml_node& dict, const char* name);
/// Of an array; what is no number counts as 0.
[[nodiscard]] std::vector<double> plistNumbers(const pugi::xml_node& array);
/// "mask_0.plist: mask_shape" is not as the format says.
[[nodiscard]] Error wrongPlistField(const std::filesystem::path& project, const std::string& part,
                                    const char* field, std::string found, std::string wanted);

/// The bytes of a part that must have exactly that many. `what`: "voxels", to say what is cut
/// short.
[[nodiscard]] Result<std::vector<char>> readExactly(const std::filesystem::path& project,
                                                    const std::string& part, std::uint64_t bytes,
                                                    const char* what);
/// The row of the file (posterior first) that is row y of a slice of Palpate's.
[[nodiscard]] inline std::int32_t invesaliusRow(const GridGeometry& geometry, std::int32_t y) {
  return geometry.dims[1] - 1 - y;
}

}  // namespace palpate
