#include "app/command_collide.h"

#include <filesystem>
#include <memory>
#include <optional>

#include "app/collide_clearance.h"
#include "app/collide_files.h"
#include "app/collide_options.h"
#include "app/collide_trajectory.h"
#include "app/command.h"
#include "app/setting_report.h"
#include "app/text_table.h"
#include "core/collision/shell_file.h"
#include "core/collision/voxel_body_shell.h"
#include "core/geometry/units.h"
#include "imaging/volume_files.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct CollideCommandOptions {
  fs::path world, shell, body, poses, out, contacts;
  std::string leaf = "distance";
  int branching = 64;
  std::string method = "hierarchy";
  std::vector<std::string> options;
  int repeats = 1, threads = 1;
  CollideClearanceOptions clearance;
};

struct CollideInput {
  VoxelTree world;
  PointShell shell;
  std::vector<TrajectoryPose> poses;
  std::vector<std::string> warnings;
  std::optional<ClearanceWorld> clearance;
};

QueryMethod methodOf(const std::string& name) {
  if (name == "paper") return QueryMethod::Paper;
  if (name == "brute" || name == "brute-force") return QueryMethod::BruteForce;
  return QueryMethod::Hierarchy;
}

Result<PointShell> readShellOrBody(const CollideCommandOptions& options, const Progress& progress) {
  if (!options.shell.empty()) return readShellFile(options.shell);
  const auto body = readLabelFile(options.body);
  if (!body) return fail(body.error());
  auto shell = shellOfVoxelBody(*body, progress);
  if (!shell) return fail(Error(shell.error()).inFile(options.body.string()));
  return shell;
}

// Cheap files first, so that a typing error is not found after the long work.
Result<CollideInput> readInput(const CollideCommandOptions& options, const TreeOptions& treeOptions,
                               const CommandContext& context) {
  auto poses = readTrajectory(options.poses);
  if (!poses) return fail(poses.error());
  context.progress(0.0, "Reading the tool");
  Progress quiet;  // its own fractions would run backwards beside the tree's
  quiet.cancel = context.progress.cancel;
  auto shell = readShellOrBody(options, quiet);
  if (!shell) return fail(shell.error());
  context.progress(0.0, "Reading the world");
  auto grid = readLabelFile(options.world);
  if (!grid) return fail(grid.error());
  auto world = VoxelTree::build(*grid, {}, treeOptions, context.progress);
  if (!world) return fail(Error(world.error()).inFile(options.world.string()));
  CollideInput input{std::move(*world), std::move(*shell), std::move(*poses), {}, {}};
  if (!options.clearance.file.empty()) {
    auto clearance = buildClearanceWorld(std::move(*grid), options.clearance, treeOptions.branching,
                                         treeOptions.threads, quiet);
    if (!clearance) return fail(Error(clearance.error()).inFile(options.world.string()));
    input.clearance.emplace(std::move(*clearance));
  }
  if (!options.body.empty() && input.shell.size() > input.world.stats().surfaceVoxels) {
    input.warnings.emplace_back(
        "The body has more surface voxels than the world; with the two exchanged and the poses "
        "inverted the query has fewer points to test.");
  }
  return input;
}

nlohmann::ordered_json optionsJson(const TreeOptions& tree, const QueryOptions& query,
                                   const CollideCommandOptions& options) {
  return {{"branching", static_cast<int>(tree.branching)},
          {"leaf", leafName(tree.leaf)},
          {"surface_only", tree.surfaceOnly},
          {"tight_spheres", query.tightSpheres},
          {"one_child_skip", query.oneChildSkip},
          {"side_offset", query.sideOffset},
          {"coherence", query.coherence},
          {"stop_level", query.stopLevel},
          {"contact_budget", query.contactBudget},
          {"perceptual_mm", millimetres(query.perceptualBound)},
          {"repeats", options.repeats},
          {"threads", query.threads}};
}

std::string textReport(const CollideInput& input, const CollideQuantiles& times,
                       const std::vector<ClearanceStep>& clearances) {
  const TreeStats& stats = input.world.stats();
  TextTable table({"what", ""});
  table.add({"poses", std::to_string(input.poses.size())});
  table.add({"shell points", std::to_string(input.shell.size())});
  table.add({"surface voxels", std::to_string(stats.surfaceVoxels)});
  table.add({"memory", byteSize(stats.topologyBytes + stats.payloadBytes)});
  table.add({"built in", decimal(stats.buildMs, 1) + " ms"});
  table.add({"step, median", decimal(times.p50, 2) + " µs"});
  table.add({"step, 99 of 100", decimal(times.p99, 2) + " µs"});
  table.add({"step, longest", decimal(times.max, 2) + " µs"});
  if (input.clearance) {
    const ClearanceStep* nearest = nearestOf(clearances);
    table.add({"smallest clearance", nearest == nullptr
                                         ? "out of reach"
                                         : decimal(nearest->clearance_mm, 3) + " mm at step " +
                                               std::to_string(nearest->step)});
  }
  return table.text();
}

// All files are complete before any of them gets its name.
Result<void> writeFiles(const CollideCommandOptions& options, const CollideInput& input,
                        const QueryOptions& query, const std::vector<CollideStep>& steps,
                        const std::vector<ClearanceStep>& clearances, const Progress& progress) {
  auto out = StagedFile::create(options.out);
  if (!out) return fail(out.error());
  (void)out->add(collideCsv(steps));
  if (auto ok = out->finish(); !ok) return ok;

  std::optional<StagedFile> clearance;
  if (!options.clearance.file.empty()) {
    auto staged = StagedFile::create(options.clearance.file);
    if (!staged) return fail(staged.error());
    (void)staged->add(clearanceCsv(clearances));
    if (auto ok = staged->finish(); !ok) return ok;
    clearance.emplace(std::move(*staged));
  }
  if (!options.contacts.empty()) {
    auto contacts = StagedFile::create(options.contacts);
    if (!contacts) return fail(contacts.error());
    const Eigen::Isometry3d& X_WV = input.world.geometry().X_PV;
    if (contacts->add(kCollideContactsHeading)) {
      auto all = forEachPoseContacts(input.world, input.shell, query, input.poses, progress,
                                     [&](std::int64_t step, std::span<const Contact> found) {
                                       return contacts->add(collideContactRows(step, found, X_WV));
                                     });
      if (!all) return all;
    }
    if (auto ok = contacts->finish(); !ok) return ok;
    if (auto ok = contacts->commit(); !ok) return ok;
  }
  if (clearance) {
    if (auto ok = clearance->commit(); !ok) return ok;
  }
  return out->commit();
}

Result<CommandOutput> runCollide(const CollideCommandOptions& options,
                                 const CommandContext& context) {
  TreeOptions tree;
  tree.branching = static_cast<Branching>(options.branching);
  tree.leaf = options.leaf == "voxel" ? LeafModel::Voxel : LeafModel::Distance;
  tree.threads = options.threads;
  QueryOptions query;
  query.method = methodOf(options.method);
  query.threads = options.threads;
  if (auto ok = applyCollideOptions(options.options, tree, query); !ok) return fail(ok.error());
  if (options.shell.empty() == options.body.empty()) {
    return fail(usageError("Give one tool: either --shell or --body.")
                    .inField("--shell")
                    .advise("'palpate collide --help' shows how."));
  }
  for (const fs::path& output : {options.out, options.contacts, options.clearance.file}) {
    if (output.empty()) continue;
    if (auto ok = checkWritable(output); !ok) return fail(ok.error());
  }
  auto input = readInput(options, tree, context);
  if (!input) return fail(input.error());
  Progress measuring;  // the build's fractions have been shown already
  measuring.cancel = context.progress.cancel;
  const auto steps = runCollideTrajectory(input->world, input->shell, query, input->poses,
                                          options.repeats, measuring);
  if (!steps) return fail(Error(steps.error()).inFile(options.poses.string()));
  Result<std::vector<ClearanceStep>> clearances;
  if (input->clearance) {
    clearances = runClearanceTrajectory(*input->clearance, input->shell, options.clearance,
                                        input->poses, options.repeats, measuring);
    if (!clearances) return fail(Error(clearances.error()).inFile(options.poses.string()));
  }
  auto written = writeFiles(options, *input, query, *steps, *clearances, measuring);
  if (!written) return fail(written.error());

  const CollideQuantiles times = quantilesOf(*steps);
  CommandOutput output;
  output.json["surface_voxels"] = input->world.stats().surfaceVoxels;
  output.json["bytes"] = bytesJson(input->world.stats());
  output.json["build_ms"] = input->world.stats().buildMs;
  output.json["step_us"] = {
      {"p50", times.p50}, {"p99", times.p99}, {"p999", times.p999}, {"max", times.max}};
  output.json["method"] = methodName(query.method);
  output.json["options"] = optionsJson(tree, query, options);
  if (input->clearance) output.json["clearance"] = clearanceJson(options.clearance, *clearances);
  output.text = textReport(*input, times, *clearances);
  output.warnings = input->warnings;
  return output;
}

}  // namespace

void addCollideCommand(CommandSet& commands) {
  const auto options = std::make_shared<CollideCommandOptions>();
  CLI::App* sub = commands.add(
      "collide", "Contacts of a point shell or voxel body with a label volume, over poses",
      [options](const CommandContext& context) { return runCollide(*options, context); });
  sub->add_option("--world", options->world, "Label volume; non-zero is solid; LPS mm")->required();
  CLI::Option* shell = sub->add_option("--shell", options->shell, "PLY points with normals, mm");
  CLI::Option* body =
      sub->add_option("--body", options->body, "Label volume; its surface voxels are the shell");
  shell->excludes(body);
  sub->add_option("--poses", options->poses, "CSV: step,r00,...,tz; world = R p + t, mm")
      ->required();
  sub->add_option("--out", options->out, "CSV: step,contacts,sum_depth_mm,tests,time_us")
      ->required();
  sub->add_option("--contacts", options->contacts, "CSV of every contact, world axes, mm");
  addCollideClearanceOptions(*sub, options->clearance);
  sub->add_option("--leaf", options->leaf, "Leaf model")
      ->check(CLI::IsMember({"voxel", "distance"}))
      ->capture_default_str();
  sub->add_option("--branching", options->branching, "Children a node")
      ->check(CLI::IsMember({8, 64, 512}))
      ->capture_default_str();
  sub->add_option("--method", options->method, "How contacts are found")
      ->check(CLI::IsMember({"hierarchy", "paper", "brute", "brute-force"}))
      ->capture_default_str();
  sub->add_option(
      "--option", options->options,
      "KEY=VALUE: surface_only, tight_spheres, one_child_skip, side_offset, coherence (on, off), "
      "stop_level, contact_budget (numbers), perceptual_mm (descent of the shell stops "
      "where it could reveal no more than this). surface_only misses most contacts of a "
      "pressed-in tool");
  sub->add_option("--repeats", options->repeats, "Passes over the trajectory, each after a reset")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  sub->add_option("--threads", options->threads,
                  "Threads of the build and of the query; they change no contact")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

}  // namespace palpate
