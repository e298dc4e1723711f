// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "kinds.hpp"
#include "log_files/hostile_samples.hpp"
#include "quadtune/exports/file_set.hpp"
#include "run_program.hpp"

namespace quadtune::mutations {
namespace {

namespace fs = std::filesystem;

Files files_of(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    files[fs::relative(entry.path(), folder).string()] = bytes.str();
  }
  return files;
}

/// The files that the program writes into `folder/out`, under other names: "e/…".
Files made(const fs::path& folder, const Files& inputs, const std::vector<Command>& commands) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (const auto& [name, bytes] : inputs) std::ofstream(folder / name, std::ios::binary) << bytes;
  for (Command command : commands) {
    for (std::string& word : command)
      if (word.starts_with("@")) word = folder.string() + word.substr(1);
    const testing::ProgramResult result = testing::run_program(command);
    if (result.status != 0)
      throw std::runtime_error(
          fmt::format("a sample cannot be made: {} {}: {}", command[0], command[1], result.err));
  }
  Files files;
  for (const auto& [name, bytes] : files_of(folder))
    if (name.starts_with("out")) files["e" + name.substr(3)] = bytes;
  return files;
}

std::string small_design(const std::string& to) {
  return with(R"(name = "small"
vehicle = "uquad"
[trim]
at = "hover"
[lqr]
convention = "uquad"
inputs = "rotor-speed"
states = ["z", "psi", "phi", "theta", "vqz", "wqx", "wqy", "wqz"]
Q = [1, 1e3, 1e3, 1e3, 1, 1, 1, 1]
R = [0.01, 0.01, 0.01, 0.01]
integral = ["z", "theta"]
Q_integral = [1, 1]
method = "discrete"
dt_s = 0.01
[[export]]
to = "TO"
)",
              "TO", to);
}

std::string mambo_design() {
  return with(project_file("designs/mambo-hover.toml"),
              "[[mission]]\nname = \"hover\"\n\n[[mission]]"
              "\nname = \"take-off-and-land\"\n\n",
              "");
}

/// Commands that read an export in the folder e.
std::vector<Command> export_commands(const std::string& vehicle, bool flies) {
  std::vector<Command> commands = {
      {"verify", "@/e"},
      {"verify", "@/e"},
      {"diff", "@/e", "@/right"},
      {"diff", "@/right", "@/e"},
      {"margins", vehicle, "--gains", "@/e"},
      {"export", "@/e", "--to", "json", "-o", "@/out"},
      {"tune", "lqr", vehicle, "--match-gains", "@/e", "--starts", "1"},
      {"certify", "@/e", "--budget", "2"}};
  if (flies)
    commands.push_back(
        {"fly", vehicle, "--gains", "@/e", "--duration", "0.2", "--sensors", "ideal"});
  return commands;
}

/// An unchanged copy of the export, for comparison by `diff`.
Sample export_sample(Files files, const std::string& target, Format format,
                     const std::string& vehicle) {
  Files all = files;
  for (const auto& [name, bytes] : files) all["right" + name.substr(1)] = bytes;
  Sample sample{all, target, format, export_commands(vehicle, vehicle == "mambo")};
  return sample;
}

/// Updates the hash of a file in the manifest; otherwise only the hash would be checked.
void mend_manifest(Files& files, const std::string& target) {
  const auto manifest = files.find("e/manifest.json");
  if (manifest == files.end()) return;
  const std::string name = target.substr(2);
  const std::size_t at = manifest->second.find("\"" + name + "\"");
  const std::size_t hash = manifest->second.find("\"sha256\"", at);
  if (at == std::string::npos || hash == std::string::npos) return;
  const std::size_t open = manifest->second.find('"', hash + 8);
  manifest->second.replace(open + 1, 64, sha256(files[target]));
  const std::size_t bytes = manifest->second.find("\"size\"", at);
  if (bytes == std::string::npos) return;
  const std::size_t digits = manifest->second.find_first_of("0123456789", bytes);
  const std::size_t end = manifest->second.find_first_not_of("0123456789", digits);
  manifest->second.replace(digits, end - digits, std::to_string(files[target].size()));
}

std::vector<Kind> exports(const fs::path& folder) {
  const Files uquad =
      made(folder, {{"d.toml", small_design("uquad")}}, {{"design", "@/d.toml", "-o", "@/out"}});
  const Files json =
      made(folder, {{"d.toml", small_design("json")}}, {{"design", "@/d.toml", "-o", "@/out"}});
  const Files mambo = made(folder, {{"d.toml", mambo_design()}},
                           {{"design", "@/d.toml", "-o", "@/out", "--force"}});
  Kind manifests{"manifest of an export"};
  Kind gains{"gains.json"};
  Kind tables{"gain tables of the uquad"};
  Kind assignments{"assignments of the Mambo"};
  for (const auto& [files, vehicle] :
       {std::pair(uquad, "uquad"), {json, "uquad"}, {mambo, "mambo"}})
    manifests.samples.push_back(export_sample(files, "e/manifest.json", Format::json, vehicle));
  const auto add = [](Kind& kind, const Files& files, const std::string& target, Format format,
                      const std::string& vehicle) {
    Sample sample = export_sample(files, target, format, vehicle);
    sample.mend = [target](Files& all) { mend_manifest(all, target); };
    kind.samples.push_back(sample);
  };
  add(gains, json, "e/gains.json", Format::json, "uquad");
  // Without the manifest, no comparison with it.
  gains.samples.push_back(
      {{{"g.json", json.at("e/gains.json")}, {"right.json", json.at("e/gains.json")}},
       "g.json",
       Format::json,
       {{"diff", "@/g.json", "@/right.json"},
        {"margins", "uquad", "--gains", "@/g.json"},
        {"export", "@/g.json", "--to", "uquad", "-o", "@/out"},
        {"export", "@/g.json", "--to", "mambo", "-o", "@/out"},
        {"tune", "lqr", "uquad", "--match-gains", "@/g.json", "--starts", "1"}}});
  for (const auto& [name, bytes] : uquad)
    if (name.ends_with(".txt")) add(tables, uquad, name, Format::numbers, "uquad");
  for (const auto& [name, bytes] : mambo)
    if (name.ends_with(".m")) add(assignments, mambo, name, Format::words, "mambo");
  return {manifests, gains, tables, assignments};
}

constexpr char kCampaign[] = R"(name = "made"
vehicle = "mambo"
flights = 6
shards = 2
[[design]]
gains = "published"
[[design]]
gains = "designed"
controller = "state-feedback"
[[mission]]
mission = "hover"
duration_s = 0.2
sensors = "ideal"
[[vary]]
quantity = "mass"
normal = { deviation = 0.04, least = 0.85, most = 1.2 }
[keep]
failures = 0
)";

std::vector<Kind> campaigns(const fs::path& folder) {
  const Files files = made(folder, {{"c.toml", kCampaign}},
                           {{"campaign", "init", "@/c.toml", "@/out"},
                            {"campaign", "work", "@/out", "--shard", "0"},
                            {"campaign", "work", "@/out", "--shard", "1"}});
  const std::vector<Command> commands = {{"campaign", "status", "@/e"},
                                         {"campaign", "merge", "@/e"},
                                         {"campaign", "work", "@/e", "--shard", "0"},
                                         {"campaign", "work", "@/e", "--shard", "1"},
                                         {"campaign", "replay", "@/e", "--flight", "3"}};
  const auto mend = [](Files& all) { all["e/plan.sha256"] = sha256(all["e/plan.json"]) + "\n"; };
  Kind plans{"plan of a campaign"};
  plans.samples.push_back({files, "e/plan.json", Format::json, commands, mend});
  plans.samples.push_back({files, "e/plan.json", Format::json, commands, mend});
  for (const auto& [name, bytes] : files)
    if (name.starts_with("e/gains-"))
      plans.samples.push_back({files, name, Format::json, commands});
  plans.samples.push_back({files, "e/plan.sha256", Format::words, commands});
  Kind records{"records of a campaign"};
  records.samples.push_back({files, "e/00000.flights", Format::records, commands});
  Files parts = files;
  parts["e/00001.host-1-1700000000000.part"] = parts["e/00001.flights"];
  parts.erase("e/00001.flights");
  records.samples.push_back(
      {parts, "e/00001.host-1-1700000000000.part", Format::records, commands});
  return {plans, records};
}

/// Files that only the library reads; the first word names the function.
Kind schedules(const fs::path& folder) {
  const Command lqr = {"lqr", "uquad", "--schedule", "speed=0:1:1,mass=0.9:0.2:1.1",
                       "--R", "0.01",  "--states",   "no-position",
                       "-o",  "@/out"};
  Kind kind{"gain schedule"};
  for (const char* name : {"s.toml", "s.json"}) {
    Command command = lqr;
    command.back() += std::string("/") + name;
    const Files files = made(folder, {}, {command});
    kind.samples.push_back({files,
                            std::string("e/") + name,
                            std::string(name) == "s.toml" ? Format::toml : Format::json,
                            {{"(library)", "schedule", std::string("@/e/") + name}}});
  }
  return kind;
}

Kind flight_logs() {
  Kind kind{"flight log"};
  kind.samples.push_back({{{"f.csv",
                            "# quadtune-log,1\n# rows,3\n# about,vehicle,mambo\n# event,0.0025,"
                            "tilt,\"rolled 1.2 rad, more\"\nt[s],x.px[m],gps.px[m]\n0,0.1,\n0.005,"
                            "-2,3\n0.01,inf,\n"}},
                          "f.csv",
                          Format::numbers,
                          {{"(library)", "flight log", "@/f.csv"}, {"log", "@/f.csv"}}});
  kind.samples.push_back({{{"f.mat", bytes_of_mat(testing::small_log())}},
                          "f.mat",
                          Format::mat,
                          {{"(library)", "flight log", "@/f.mat"}, {"log", "@/f.mat"}}});
  return kind;
}

Kind imu_calibrations(const fs::path& folder) {
  Files files = made(folder, {}, {{"calibrate", "imu", "--simulate", "-o", "@/out/c.txt"}});
  return {"imu_calib.txt",
          {{files,
            "e/c.txt",
            Format::numbers,
            {{"(library)", "imu calibration", "@/e/c.txt"},
             {"calibrate", "imu", "--simulate", "--base", "@/e/c.txt"}}}}};
}

}  // namespace

std::vector<Kind> made_kinds(const std::string& folder) {
  std::vector<Kind> kinds = exports(folder);
  for (std::vector<Kind> more :
       {campaigns(folder),
        std::vector<Kind>{schedules(folder), flight_logs(), imu_calibrations(folder)}})
    for (Kind& kind : more) kinds.push_back(std::move(kind));
  fs::remove_all(folder);
  return kinds;
}

}  // namespace quadtune::mutations
