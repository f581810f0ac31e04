#include <sys/resource.h>
#include <sys/utsname.h>

#include <cmath>
#include <memory>
#include <thread>

#include "app/command.h"
#include "app/commands.h"
#include "app/desktop_options.h"
#include "app/program_paths.h"
#include "app/text_table.h"
#include "app/wakeup_jitter.h"
#include "core/simulation/real_time.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

constexpr double kGoodP999Us = 100.0;   // a tenth of the servo period
constexpr double kUsableP99Us = 500.0;  // the servo still has half its period

/// What the numbers mean for somebody who wants to hold a device.
std::string verdict(const JitterReport& report) {
  if (report.p999_us <= kGoodP999Us && report.missed == 0) {
    return "Good: this machine wakes a 1 kHz loop in time.";
  }
  if (report.p99_us <= kUsableP99Us) {
    return "Usable: now and then a wake-up is late; the force may tick. Close other programs, and "
           "allow real-time priority if it was refused.";
  }
  return "Not for a device: wake-ups are late too often. Use the virtual clock here, or a machine "
         "that is not shared and grants real-time priority.";
}

ordered_json limitJson(rlim_t limit, double unit) {
  if (limit == RLIM_INFINITY) return "unlimited";
  return static_cast<double>(limit) / unit;
}

ordered_json machineJson() {
  utsname name{};
  ::uname(&name);
  rlimit priority{}, memory{};
  ::getrlimit(RLIMIT_RTPRIO, &priority);
  ::getrlimit(RLIMIT_MEMLOCK, &memory);
  ordered_json json;
  json["kernel"] = std::string(name.sysname) + " " + name.release;
  json["processors"] = std::thread::hardware_concurrency();
  json["rtprio_limit"] = limitJson(priority.rlim_cur, 1.0);
  json["memlock_limit_KiB"] = limitJson(memory.rlim_cur, 1024.0);
  return json;
}

ordered_json jitterJson(const JitterReport& report) {
  ordered_json json;
  json["wakeups"] = report.wakeups;
  json["lateness_us"] = {{"p50", report.p50_us},
                         {"p99", report.p99_us},
                         {"p999", report.p999_us},
                         {"max", report.max_us}};
  json["late"] = report.late;
  json["missed"] = report.missed;
  json["histogram"] = ordered_json::array();
  for (const JitterBin& bin : report.histogram) {
    const ordered_json to = std::isfinite(bin.to_us) ? ordered_json(bin.to_us) : nullptr;
    json["histogram"].push_back({{"from_us", bin.from_us}, {"to_us", to}, {"count", bin.count}});
  }
  return json;
}

struct ProcessorRow {
  int processor = 0;
  JitterReport report;
};

/// A shorter look at each processor alone: not at hundreds of them.
Result<std::vector<ProcessorRow>> lookAtEach(double seconds, const Progress& progress) {
  constexpr std::size_t kMost = 16;
  std::vector<int> all = usableProcessors();
  if (all.size() > kMost) all.resize(kMost);
  std::vector<ProcessorRow> rows;
  for (const int processor : all) {
    const double each = std::max(0.05, seconds / static_cast<double>(all.size()));
    auto report = measureWakeupJitter(each, progress, processor);
    if (!report) return fail(report.error());
    rows.push_back({processor, std::move(*report)});
  }
  return rows;
}

/// The one whose late wake-ups are rarest and least.
const ProcessorRow* steadiest(const std::vector<ProcessorRow>& rows) {
  const auto best = std::min_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return a.report.missed != b.report.missed ? a.report.missed < b.report.missed
                                              : a.report.p99_us < b.report.p99_us;
  });
  return best == rows.end() ? nullptr : &*best;
}

void tellProcessors(const std::vector<ProcessorRow>& rows, CommandOutput& output,
                    TextTable& table) {
  output.json["processors"] = ordered_json::array();
  for (const ProcessorRow& row : rows) {
    output.json["processors"].push_back({{"processor", row.processor},
                                         {"p50_us", row.report.p50_us},
                                         {"p99_us", row.report.p99_us},
                                         {"max_us", row.report.max_us},
                                         {"missed", row.report.missed}});
    table.add({"processor " + std::to_string(row.processor) + ", p50 / p99 / max, missed",
               decimal(row.report.p50_us, 1) + " / " + decimal(row.report.p99_us, 1) + " / " +
                   decimal(row.report.max_us, 1) + " µs, " + std::to_string(row.report.missed)});
  }
  const int isolated = isolatedProcessor();
  const ProcessorRow* best = steadiest(rows);
  output.json["isolated_processor"] = isolated >= 0 ? ordered_json(isolated) : nullptr;
  output.json["steadiest_processor"] =
      best != nullptr ? ordered_json(best->processor) : ordered_json(nullptr);
  if (isolated >= 0) {
    table.add({"processor for the servo", std::to_string(isolated) + ": the system keeps it free"});
  } else if (best != nullptr && rows.size() > 1) {
    table.add({"processor for the servo",
               std::to_string(best->processor) + " was the steadiest just now (--servo-cpu " +
                   std::to_string(best->processor) +
                   "); isolcpus= on the kernel's command line keeps one free for good"});
  }
}

std::string histogramText(const JitterReport& report) {
  std::uint64_t most = 1;
  for (const JitterBin& bin : report.histogram) most = std::max(most, bin.count);
  TextTable table({"late by", "wake-ups", ""});
  for (const JitterBin& bin : report.histogram) {
    const auto bar = bin.count == 0 ? 0 : 1 + bin.count * 39 / most;
    const std::string to = std::isfinite(bin.to_us) ? decimal(bin.to_us, 0) : "more";
    table.add({decimal(bin.from_us, 0) + " to " + to + " µs", std::to_string(bin.count),
               std::string(bar, '#')});
  }
  return table.text();
}

Result<CommandOutput> runDoctor(double seconds, const CommandContext& context) {
  const Result<JitterReport> report = measureWakeupJitter(seconds, context.progress);
  if (!report) return fail(report.error());
  const auto processors = lookAtEach(0.4 * seconds, context.progress);
  if (!processors) return fail(processors.error());
  const Result<std::filesystem::path> data = programDataFolder();
  CommandOutput output;
  output.json = jitterJson(*report);
  output.json["seconds"] = seconds;
  output.json["priority"] = {{"realtime", report->realTimePriority},
                             {"note", report->priorityNote}};
  output.json["memlock"] = {{"locked", report->memoryLocked}, {"note", report->memoryNote}};
  output.json["machine"] = machineJson();
  output.json["display"] = displayIsThere();
  output.json["program_data"] = data.has_value();
  output.json["demo_scan"] = !demoScanFile().empty();
  output.json["verdict"] = verdict(*report);

  TextTable table({"check", "found"});
  table.add({"wake-ups in " + decimal(seconds, 1) + " s", std::to_string(report->wakeups)});
  table.add({"lateness p50 / p99 / p99.9 / max",
             decimal(report->p50_us, 1) + " / " + decimal(report->p99_us, 1) + " / " +
                 decimal(report->p999_us, 1) + " / " + decimal(report->max_us, 1) + " µs"});
  table.add({"late (over 100 µs), periods missed",
             std::to_string(report->late) + ", " + std::to_string(report->missed)});
  tellProcessors(*processors, output, table);
  table.add({"real-time priority", report->realTimePriority ? "granted" : report->priorityNote});
  table.add({"locked memory", report->memoryLocked ? "granted" : report->memoryNote});
  table.add({"display", displayIsThere() ? "there" : "none: only commands without a window"});
  table.add({"program data", data ? "found" : sentence(data.error())});
  table.add(
      {"demo scan", demoScanFile().empty() ? "not installed (invesalius-examples)" : "found"});
  output.text = histogramText(*report) + "\n" + table.text() + "\n" + verdict(*report) + "\n";
  return output;
}

}  // namespace

void addDoctorCommand(CommandSet& commands) {
  const auto seconds = std::make_shared<double>(5.0);
  CLI::App* sub = commands.add(
      "doctor", "Measures this machine: wake-ups of a 1 kHz loop, priority, memory, display",
      [seconds](const CommandContext& context) { return runDoctor(*seconds, context); });
  sub->add_option("--seconds", *seconds, "How long to measure")
      ->check(CLI::Range(0.05, 600.0))
      ->capture_default_str();
}

}  // namespace palpate
