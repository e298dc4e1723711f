// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "kinds.hpp"
#include "run_program.hpp"
#include "source_folder.hpp"

namespace quadtune::mutations {

std::string project_file(const std::string& name) {
  std::ifstream file(testing::source_folder() + "/" + name, std::ios::binary);
  if (!file) throw std::runtime_error(name + ": cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string with(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) throw std::runtime_error("'" + part + "' is not in the sample");
  return text.replace(at, part.size(), by);
}

std::map<std::string, std::vector<std::string>> options_of_commands() {
  std::map<std::string, std::vector<std::string>> all;
  const auto help = nlohmann::json::parse(testing::run_program({"help", "--json"}).out);
  for (const auto& command : help.at("commands"))
    for (const auto& option : command.at("options")) {
      const auto names = option.at("option").get<std::string>();
      all[command.at("name")].push_back(names.substr(0, names.find(' ')));
    }
  return all;
}

Kind command_lines() {
  const Files files = {{"A", "0 1\n-1 -1\n"},
                       {"B", "0\n1\n"},
                       {"C", "1 0\n"},
                       {"Q", "1 0\n0 2\n"},
                       {"R", "1\n"},
                       {"K", "1 0.5\n"},
                       {"Ad", "0.9 0.1\n-0.1 0.8\n"},
                       {"v.toml", project_file("vehicles/mambo.toml")},
                       {"log.csv", small_log_text()}};
  const std::vector<Command> lines = {
      {"vehicle", "list"},
      {"vehicle", "show", "mambo"},
      {"vehicle", "check", "@/v.toml"},
      {"linearize", "uquad", "--at", "circle", "--speed", "1", "--radius", "2", "--convention",
       "uquad", "--inputs", "rotor-speed"},
      {"linearize", "@/v.toml", "--at", "spin", "--yaw-rate", "0.5", "--states", "no-position"},
      {"linearize", "mambo", "--at", "line", "--climb", "0.2", "--yaw", "1"},
      {"lqr", "--A", "@/A", "--B", "@/B", "--Q", "@/Q", "--R", "@/R", "--sampled", "0.1"},
      {"lqr", "mambo", "--Q", "1", "--R", "1", "--integral", "psi", "--method", "sampled", "--dt",
       "0.01", "--states", "phi,theta,psi,p,q,r"},
      {"lqr", "mambo", "--schedule", "speed=0:1:1, mass=1", "--R", "1", "--states", "no-position"},
      {"kalman", "--A", "@/Ad", "--C", "@/C", "--Q", "@/Q", "--R", "@/R", "--discrete"},
      {"discretize", "--A", "@/A", "--B", "@/B", "--dt", "0.1", "--method", "tustin", "--prewarp",
       "2"},
      {"discretize", "--num", "1,2", "--den", "1,3,2", "--dt", "0.1", "--method", "matched"},
      {"discretize", "--num", "1", "--den", "1,1", "--dt", "0.1", "--delay", "0.25"},
      {"discretize", "--num", "0.1", "--den", "1,-0.9", "--dt", "0.1", "--inverse"},
      {"margins", "--num", "25", "--den", "1,10,10,10", "--delay", "0.01"},
      {"margins", "--num", "0.1,0.1", "--den", "1,-1.5,0.6", "--dt", "0.1"},
      {"margins", "--A", "@/A", "--B", "@/B", "--K", "@/K", "--cut", "states"},
      {"pid", "--num", "1", "--den", "1,3,3,1", "--type", "PI", "--crossover", "0.5",
       "--phase-margin", "60"},
      {"pid", "--num", "1", "--den", "1,3,3,1", "--type", "PID", "--rule", "simc", "--tau-c", "1",
       "--delay", "0.2"},
      {"pid", "--num", "1", "--den", "1,3,3,1", "--type", "PI", "--Ms-max", "1.6"},
      {"fly", "mambo", "--gains", "published", "--mission", "hover", "--duration", "0.3", "--wind",
       "north=3,gust_east=2,gust_at=0.1", "--solver", "runge-kutta-4", "--step", "0.005"},
      {"compare", "gains", "mambo", "published", "published", "--duration", "0.3"},
      {"log", "@/log.csv", "--columns", "t_s:1, height[m]:4, *"},
      {"tune", "kalman", "--model", "local-level", "--log", "@/log.csv", "--map", "y=y",
       "--holdout", "0.2", "--starts", "1"},
      {"tune", "pid", "mambo", "--gains", "published", "--mission", "hover", "--duration", "6",
       "--sensors", "ideal", "--evaluations", "1", "--monte-carlo", "1", "--proof", "2"},
      {"allan", "--log", "@/log.csv", "--column", "y", "--taus", "all"},
      {"calibrate", "imu", "--log", "@/log.csv", "--accelerometer", "2,3,4", "--temperature",
       "none"},
      {"export", "@/none.toml", "--to", "json", "-o", "@/out"},
      {"verify", "@/none"},
      {"diff", "@/none", "@/none"},
      // Not `link send`: a changed address could be that of somebody's vehicle.
      {"link", "encode", "move", "10", "-20", "30", "-40", "--firmware", "native", "--sequence",
       "7"},
      {"link", "decode", "0e", "00", "00", "00", "e2", "ff", "ff", "ff", "--firmware", "simulink"},
      {"help", "lqr"},
      {"help"},
      {"--version"}};
  Kind kind{"command line"};
  kind.samples.push_back({files, "", Format::words, lines});
  return kind;
}

std::vector<Kind> all_kinds(const std::string& folder) {
  std::vector<Kind> kinds = written_kinds();
  for (std::vector<Kind> more : {number_kinds(), made_kinds(folder)})
    for (Kind& kind : more) kinds.push_back(std::move(kind));
  kinds.push_back(command_lines());
  return kinds;
}

}  // namespace quadtune::mutations
