#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/whole_file.h"
#include "core/geometry/pose.h"
#include "core/geometry/units.h"
#include "core/scene/scene.h"
#include "core/scene/scene_text.h"
#include "core/scene/toml_reader.h"

namespace palpate {
namespace {

// The format of scene.toml; a later program that writes more raises it.
constexpr std::uint32_t kFormat = 1;

struct MethodName {
  const char* name;
  QueryMethod method;
};
constexpr MethodName kMethods[] = {{"hierarchy", QueryMethod::Hierarchy},
                                   {"paper", QueryMethod::Paper},
                                   {"brute-force", QueryMethod::BruteForce}};

struct ReachName {
  const char* name;
  Reach reach;
};
constexpr ReachName kReaches[] = {
    {"all", Reach::All}, {"sealed", Reach::Sealed}, {"device", Reach::Device}};

void readReach(TomlTable& root, Reach& reach) {
  std::string name;
  for (const auto& row : kReaches) {
    if (row.reach == reach) name = row.name;
  }
  root.text("reach", name);
  for (const auto& row : kReaches) {
    if (name != row.name) continue;
    reach = row.reach;
    return;
  }
  root.refuse("reach", "There is no such reach.", name, "all, sealed or device");
}

/// [region] or [workspace], where there is one.
std::optional<SceneBox> readBox(TomlFile& file, TomlTable& root, const char* key) {
  const toml::table* found = root.table(key);
  if (found == nullptr) return std::nullopt;
  TomlTable table(file, *found, std::string(key) + ".", {"min_mm", "max_mm"});
  SceneBox box;
  table.numbers("min_mm", box.least_mm.data(), 3, {-1e5, 1e5}, Need::Required);
  table.numbers("max_mm", box.most_mm.data(), 3, {-1e5, 1e5}, Need::Required);
  for (int axis = 0; axis < 3 && !table.failed(); ++axis) {
    if (box.least_mm[axis] < box.most_mm[axis]) continue;
    table.refuse("max_mm", "A box has no inside.",
                 exactText(box.most_mm[axis]) + " along " + "xyz"[axis],
                 "more than min_mm, " + exactText(box.least_mm[axis]));
  }
  return box;
}

void readTree(TomlTable& table, TreeOptions& tree) {
  auto branching = static_cast<std::uint32_t>(tree.branching);
  table.integer("branching", branching, {8, 512});
  if (branching != 8 && branching != 64 && branching != 512) {
    table.refuse("branching", "A tree has 8, 64 or 512 children a node.", std::to_string(branching),
                 "8, 64 or 512");
  }
  tree.branching = static_cast<Branching>(branching);
  std::string leaf = tree.leaf == LeafModel::Voxel ? "voxel" : "distance";
  table.text("leaf", leaf);
  if (leaf != "voxel" && leaf != "distance") {
    table.refuse("leaf", "There is no such leaf model.", leaf, "voxel or distance");
  }
  tree.leaf = leaf == "voxel" ? LeafModel::Voxel : LeafModel::Distance;
  table.flag("surface_only", tree.surfaceOnly);
}

void readQuery(TomlTable& table, QueryOptions& query) {
  std::string method = "hierarchy";
  table.text("method", method);
  bool known = false;
  for (const auto& row : kMethods) {
    if (method != row.name) continue;
    query.method = row.method;
    known = true;
  }
  if (!known) {
    table.refuse("method", "There is no such query method.", method,
                 "hierarchy, paper or brute-force");
  }
  table.flag("tight_spheres", query.tightSpheres);
  table.flag("one_child_skip", query.oneChildSkip);
  table.flag("side_offset", query.sideOffset);
  std::uint32_t stopLevel = 0;
  table.integer("stop_level", stopLevel, {0, 10});
  query.stopLevel = static_cast<int>(stopLevel);
  table.integer("contact_budget", query.contactBudget,
                {1, static_cast<double>(std::numeric_limits<std::uint32_t>::max())});
  double perceptual_mm = 0.0;
  table.number("perceptual_mm", perceptual_mm, {0.0, 100.0});
  query.perceptualBound = metres(perceptual_mm);
}

void readSetting(TomlTable& table, SimulationSetting& setting) {
  readTree(table, setting.tree);
  readQuery(table, setting.query);
  double spacing_mm = 0.0;
  table.number("shell_spacing_mm", spacing_mm, {0.05, 20.0});
  setting.shellSpacing = metres(spacing_mm);
  double period_ms = 1.0;
  table.number("step_period_ms", period_ms, {1.0, 100.0});
  if (std::floor(period_ms) != period_ms) {
    table.refuse("step_period_ms", "A step must last a whole number of servo periods of 1 ms.",
                 exactText(period_ms), "a whole number of ms");
  }
  setting.stepPeriod = period_ms / 1e3;  // the nearest double, as a literal 0.003 is
  table.integer("contact_capacity", setting.contactCapacity, {1, 1000000});
  table.integer("solver_iterations", setting.solverIterations, {1, 100000});
  table.flag("friction", setting.friction);
  table.number("coupling_share", setting.couplingShare, {0.1, 1.0});
}

SceneBody readBody(TomlFile& file, const toml::table& table, std::size_t number) {
  TomlTable row(file, table, "body[" + std::to_string(number) + "].",
                {"label", "separate", "least_volume_mm3"});
  SceneBody body;
  row.text("label", body.label, Need::Required);
  row.flag("separate", body.separate);
  row.number("least_volume_mm3", body.leastVolume_mm3, {0.0, 1e9});
  return body;
}

Surroundings readSurroundings(TomlTable& table) {
  Surroundings around;
  double gravity[3] = {0, 0, 0};
  table.numbers("gravity_m_per_s2", gravity, 3, {-100, 100}, Need::Optional);
  table.number("drag_per_s", around.drag, {0.0, 1000.0});
  around.gravity = Eigen::Vector3d(gravity[0], gravity[1], gravity[2]);
  return around;
}

/// [[body]], where there is any.
std::vector<SceneBody> readBodies(TomlFile& file, TomlTable& root) {
  std::vector<SceneBody> bodies;
  if (!file.root.contains("body")) return bodies;
  for (const toml::table* table : root.tables("body")) {
    bodies.push_back(readBody(file, *table, bodies.size()));
    const auto twice = std::count_if(bodies.begin(), bodies.end(), [&bodies](const SceneBody& b) {
      return b.label == bodies.back().label;
    });
    if (twice > 1) {
      root.refuse("body", "Two bodies are of one label.", bodies.back().label,
                  "a label each; parts of a label are told apart with separate = true");
    }
  }
  return bodies;
}

Eigen::Isometry3d readDevicePose(TomlTable& table) {
  double origin_mm[3] = {0, 0, 0};
  double q[4] = {1, 0, 0, 0};
  table.numbers("origin_mm", origin_mm, 3, {-1e5, 1e5}, Need::Required);
  table.numbers("rotation_wxyz", q, 4, {-1, 1}, Need::Required);
  Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  // What a person types is rarely a unit quaternion to the last digit; 1e-3 is still a slip.
  if (std::abs(rotation.norm() - 1.0) > 1e-3) {
    table.refuse("rotation_wxyz", "A rotation is not a unit quaternion.",
                 "length " + exactText(rotation.norm()), "length 1 within 0.001");
  } else {
    rotation.normalize();
  }
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  X_WD.linear() = rotation.toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) X_WD.translation()[axis] = metres(origin_mm[axis]);
  return X_WD;
}

Result<Scene> sceneFrom(TomlFile file, Scene scene) {
  TomlTable root(file, file.root, "",
                 {"format", "name", "labels", "instrument", "device", "reach", "region",
                  "workspace", "device_pose", "body", "surroundings", "setting"});
  std::uint32_t format = 0;
  root.integer("format", format, {1, 1e6}, Need::Required);
  if (!root.failed() && format > kFormat) {
    root.refuse("format", "The scene was written by a later version of this program.",
                std::to_string(format), "at most " + std::to_string(kFormat));
    file.error->advise("Update the program.");
  }
  root.text("name", scene.name);
  root.texts("labels", scene.labels);
  root.text("instrument", scene.instrument);
  root.text("device", scene.device);
  readReach(root, scene.reach);
  scene.region = readBox(file, root, "region");
  scene.workspace = readBox(file, root, "workspace");
  if (const toml::table* pose = root.table("device_pose")) {
    TomlTable table(file, *pose, "device_pose.", {"origin_mm", "rotation_wxyz"});
    scene.X_WD = readDevicePose(table);
  }
  scene.bodies = readBodies(file, root);
  if (const toml::table* around = root.table("surroundings")) {
    TomlTable table(file, *around, "surroundings.", {"gravity_m_per_s2", "drag_per_s"});
    scene.surroundings = readSurroundings(table);
  }
  if (const toml::table* setting = root.table("setting")) {
    TomlTable table(
        file, *setting, "setting.",
        {"branching", "leaf", "surface_only", "method", "tight_spheres", "one_child_skip",
         "side_offset", "stop_level", "contact_budget", "perceptual_mm", "shell_spacing_mm",
         "step_period_ms", "contact_capacity", "solver_iterations", "friction", "coupling_share"});
    readSetting(table, scene.setting);
  }
  if (file.error) return fail(*file.error);
  return scene;
}

const char* word(bool value) {
  return value ? "true" : "false";
}

std::string devicePoseText(const Eigen::Isometry3d& X_WD) {
  const PlainPose pose = plain(X_WD);
  std::string text = "\n[device_pose]\norigin_mm = [";
  for (int axis = 0; axis < 3; ++axis) {
    text += (axis > 0 ? ", " : "") + exactText(exactMillimetres(pose.p[axis]));
  }
  text += "]\nrotation_wxyz = [";
  for (int axis = 0; axis < 4; ++axis) text += (axis > 0 ? ", " : "") + exactText(pose.q[axis]);
  return text + "]\n";
}

std::string boxText(const char* key, const std::optional<SceneBox>& box) {
  if (!box) return "";
  std::string text = std::string("\n[") + key + "]\n";
  const auto line = [&text](const char* name, const Eigen::Vector3d& corner) {
    text += std::string(name) + " = [" + exactText(corner.x()) + ", " + exactText(corner.y()) +
            ", " + exactText(corner.z()) + "]\n";
  };
  line("min_mm", box->least_mm);
  line("max_mm", box->most_mm);
  return text;
}

std::string settingText(const SimulationSetting& setting) {
  const TreeOptions& tree = setting.tree;
  const QueryOptions& query = setting.query;
  std::string text = "\n[setting]\n";
  const auto line = [&text](const char* key, const std::string& value) {
    text += std::string(key) + " = " + value + "\n";
  };
  line("branching", std::to_string(static_cast<int>(tree.branching)));
  line("leaf", tree.leaf == LeafModel::Voxel ? "\"voxel\"" : "\"distance\"");
  line("surface_only", word(tree.surfaceOnly));
  for (const auto& row : kMethods) {
    if (row.method == query.method) line("method", quoted(row.name));
  }
  line("tight_spheres", word(query.tightSpheres));
  line("one_child_skip", word(query.oneChildSkip));
  line("side_offset", word(query.sideOffset));
  line("stop_level", std::to_string(query.stopLevel));
  if (query.contactBudget != QueryOptions{}.contactBudget) {
    line("contact_budget", std::to_string(query.contactBudget));
  }
  if (query.perceptualBound > 0.0) {
    line("perceptual_mm", exactText(exactMillimetres(query.perceptualBound)));
  }
  if (setting.shellSpacing > 0.0) {
    line("shell_spacing_mm", exactText(exactMillimetres(setting.shellSpacing)));
  }
  line("step_period_ms", exactText(std::round(setting.stepPeriod * 1e3)));
  line("contact_capacity", std::to_string(setting.contactCapacity));
  line("solver_iterations", std::to_string(setting.solverIterations));
  line("friction", word(setting.friction));
  if (setting.couplingShare != 1.0) line("coupling_share", exactText(setting.couplingShare));
  return text;
}

std::string bodyText(const Scene& scene) {
  std::string text;
  for (const SceneBody& body : scene.bodies) {
    text += "\n[[body]]\nlabel = " + quoted(body.label) + "\n";
    text += std::string("separate = ") + word(body.separate) + "\n";
    text += "least_volume_mm3 = " + exactText(body.leastVolume_mm3) + "\n";
  }
  if (scene.bodies.empty()) return text;
  const Surroundings& around = scene.surroundings;
  text += "\n[surroundings]\ngravity_m_per_s2 = [";
  for (int axis = 0; axis < 3; ++axis) {
    text += (axis > 0 ? ", " : "") + exactText(around.gravity[axis]);
  }
  return text + "]\ndrag_per_s = " + exactText(around.drag) + "\n";
}

}  // namespace

std::string sceneText(const Scene& scene) {
  std::string text = "# A scene of Palpate. Lengths in mm, patient axes (DICOM LPS).\n";
  text += "format = " + std::to_string(kFormat) + "\n";
  text += "name = " + quoted(scene.name) + "\n";
  text += "labels = [";
  for (std::size_t i = 0; i < scene.labels.size(); ++i) {
    text += (i > 0 ? ", " : "") + quoted(scene.labels[i]);
  }
  text += "]  # empty: every label is felt\n";
  text += "instrument = " + quoted(scene.instrument) + "\n";
  text += "device = " + quoted(scene.device) + "\n";
  for (const auto& row : kReaches) {
    if (row.reach == scene.reach) text += "reach = " + quoted(row.name) + "\n";
  }
  text += boxText("region", scene.region) + boxText("workspace", scene.workspace);
  if (scene.X_WD) text += devicePoseText(*scene.X_WD);
  return text + bodyText(scene) + settingText(scene.setting);
}

Result<Scene> sceneFromText(const std::string& text, const std::string& path, const Scene& absent) {
  auto file = parseTomlText(text, path);
  if (!file) return fail(file.error());
  return sceneFrom(std::move(*file), absent);
}

Result<Scene> readScene(const std::filesystem::path& path) {
  auto file = parseTomlFile(path);
  if (!file) return fail(file.error());
  return sceneFrom(std::move(*file), {});
}

Result<void> writeScene(const Scene& scene, const std::filesystem::path& file) {
  return writeWholeFile(file, sceneText(scene));
}

}  // namespace palpate
