// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <utility>

#include "kinds.hpp"
#include "random.hpp"

namespace quadtune::mutations {
namespace {

Kind vehicles() {
  Kind kind{"vehicle file"};
  for (const char* name : {"mambo", "uquad", "crazyflie", "rolling-spider"}) {
    Sample sample{{{"v.toml", project_file(std::string("vehicles/") + name + ".toml")}},
                  "v.toml",
                  Format::toml,
                  {{"vehicle", "check", "@/v.toml"},
                   {"vehicle", "check", "@/v.toml"},
                   {"vehicle", "show", "@/v.toml"},
                   {"linearize", "@/v.toml"},
                   {"linearize", "@/v.toml", "--at", "circle", "--speed", "1", "--radius", "3"},
                   {"lqr", "@/v.toml", "--Q", "1", "--R", "1", "--states", "no-position"},
                   {"fly", "@/v.toml", "--controller", "state-feedback", "--duration", "0.3"}}};
    if (std::string(name) == "mambo")
      sample.commands.push_back({"fly", "@/v.toml", "--gains", "published", "--duration", "0.3"});
    kind.samples.push_back(sample);
  }
  kind.samples.push_back(
      {{{"v.toml", R"(name = "plus"
[environment]
gravity_m_per_s2 = 9.8
[body]
drag_linear_N_s_per_m = [0.1, 0.1, 0.2]
[body.geometry]
spheres = [{ mass_kg = 0.043, radius_m = 0.03 }]
points = [
  { mass_kg = 0.005, position_m = [0.0624, 0, 0] }, { mass_kg = 0.005, position_m = [0, 0.0624, 0] },
  { mass_kg = 0.005, position_m = [-0.0624, 0, 0] }, { mass_kg = 0.005, position_m = [0, -0.0624, 0] },
]
[rotor]
thrust_a2_N_s2_per_rad2 = 1e-7
torque_d2_N_m_s2_per_rad2 = 1e-9
lag_s = 0.02
[motor]
command = "speed"
min_rad_s = 100
max_rad_s = 3000
[[rotors]]
position_m = [0.06, 0, 0]
spin = "cw"
[[rotors]]
position_m = [0, 0.06, 0]
spin = "ccw"
[[rotors]]
position_m = [-0.06, 0, 0]
spin = "cw"
[[rotors]]
position_m = [0, -0.06, 0]
spin = "ccw"
[sensors.gps]
rate_Hz = 10
[sensors.accelerometer]
rate_Hz = 200
noise_m_per_s2 = [0.1, 0.1, 0.1]
[sensors.gyroscope]
rate_Hz = 200
[sensors.magnetometer]
rate_Hz = 50
[sensors.barometer]
rate_Hz = 50
[battery]
capacity_A_h = 0.55
full_voltage_V = 4.2
empty_voltage_V = 3.2
)"}},
       "v.toml",
       Format::toml,
       {{"vehicle", "check", "@/v.toml"},
        {"vehicle", "show", "@/v.toml"},
        {"linearize", "@/v.toml"},
        {"fly", "@/v.toml", "--controller", "state-feedback", "--duration", "0.3"}}});
  return kind;
}

/// The project's design without its missions.
std::string design(const std::string& name) {
  std::string text = project_file("designs/" + name + ".toml");
  for (std::size_t at = text.find("[[mission]]"); at != std::string::npos;
       at = text.find("[[mission]]"))
    text.erase(at, text.find("\n\n", at) + 2 - at);
  return text;
}

constexpr char kFilters[] = R"(name = "filters"
vehicle = "mambo"
[[kalman]]
name = "altitude"
dt_s = 0.005
states = [{ name = "z", unit = "m" }, { name = "vz", unit = "m/s" }]
inputs = [{ name = "az", unit = "m/s^2" }]
measurements = [{ name = "z_sonar", unit = "m" }]
A = [[1, 0.005], [0, 1]]
B = [[0], [0.005]]
C = [[1, 0]]
G = [[0], [1]]
tuned = "tuned.toml"
[cascade]
dt_s = 0.005
attitude_limit_rad = 0.5
x = { Kp = -0.24, Kd = 0.1 }
y = { Kp = 0.24, Kd = -0.1 }
pitch = { Kp = 0.013, Ki = 0.01, Kd = -0.002 }
roll = { Kp = 0.01, Ki = 0.01, Kd = -0.003 }
yaw = { Kp = 0.004, Kd = -0.0012 }
altitude = { Kp = -0.8, Ki = -0.1, Kd = 0.5 }
[[export]]
to = "json"
)";

std::string tuned_altitude() {
  return with(with(project_file("filters/altitude.toml"), "name = \"altitude\"",
                   "name = \"altitude\"\nverdict = \"pass\""),
              "variance = 0.1\n\n[[sensors]]",
              "variance = 0.1\ninterval = [0.05, 0.2]\n\n[[sensors]]");
}

Kind designs() {
  const std::vector<Command> common = {{"design", "@/d.toml", "-o", "@/out"},
                                       {"design", "@/d.toml"},
                                       {"export", "@/d.toml", "--to", "json", "-o", "@/out"}};
  Kind kind{"design file"};
  kind.samples.push_back({{{"d.toml", design("uquad-hover")}}, "d.toml", Format::toml, common});
  kind.samples.back().commands.push_back(
      {"tune", "lqr", "uquad", "--match-gains", "@/d.toml", "--R", "0.01", "--starts", "1"});
  kind.samples.push_back(
      {{{"d.toml", kFilters}, {"tuned.toml", tuned_altitude()}}, "d.toml", Format::toml, common});
  kind.samples.back().commands.push_back(
      {"fly", "mambo", "--gains", "@/d.toml", "--duration", "0.3"});
  kind.samples.push_back({{{"d.toml", R"(name = "small"
vehicle = "mambo"
[trim]
at = "line"
speed_m_per_s = 1
climb_m_per_s = 0.1
[lqr]
convention = "mambo"
inputs = "wrench"
states = ["psi", "theta", "phi", "phidot", "thetadot", "psidot"]
Q = [25, 25, 8, 0.25, 0.25, 0.25]
R = [123, 9.2e4, 9.2e4, 3.1e7]
method = "sampled"
dt_s = 0.005
[[export]]
to = "mambo"
[[export]]
to = "json"
)"}},
                          "d.toml",
                          Format::toml,
                          common});
  return kind;
}

Kind missions() {
  Kind kind{"mission file"};
  for (const char* name :
       {"circle", "hover", "keys", "lemniscate-carried", "lemniscate", "line", "motor-test",
        "step-east", "step-height", "step-yaw", "take-off-and-land", "waypoints"})
    kind.samples.push_back(
        {{{"m.toml", project_file(std::string("missions/") + name + ".toml")}},
         "m.toml",
         Format::toml,
         {{"fly", "mambo", "--gains", "published", "--mission", "@/m.toml", "--duration", "0.3"},
          {"fly", "mambo", "--gains", "published", "--mission", "@/m.toml", "--sensors", "ideal",
           "--log", "@/flight.csv"}}});
  return kind;
}

Kind mission_tables() {
  const std::string mission =
      "name = \"table\"\nduration_s = 1\n[start]\nat = \"air\"\nheight_m = 1\n[csv]\nfile = "
      "\"t.csv\"\n";
  const std::vector<Command> commands = {
      {"fly", "mambo", "--gains", "published", "--mission", "@/m.toml"}};
  const std::string table =
      "t_s, north_m, east_m, height_m, yaw_rad\n0, 0, 0, 1, 0\n0.3, 0.1, 0, 1.1, 0.1\n"
      "0.5, 0.2, 0.1, 1, 0.2\n0.9, 0, 0, 1, 0\n";
  return {"references of a mission",
          {{{{"m.toml", mission}, {"t.csv", table}}, "t.csv", Format::numbers, commands},
           {{{"m.toml", mission + "between = \"hold\"\n"}, {"t.csv", table}},
            "t.csv",
            Format::numbers,
            commands}}};
}

Kind campaign_kind() {
  const std::string text = R"(name = "small"
vehicle = "mambo"
flights = 2
seed = 3
shards = 1
[[design]]
name = "flown"
gains = "published"
integrator = "tustin"
[[mission]]
mission = "hover"
duration_s = 0.2
wind = "light"
[[mission]]
mission = "m.toml"
sensors = "ideal"
estimator = "truth"
[[vary]]
quantity = "mass"
normal = { deviation = 0.04, least = 0.85, most = 1.2 }
[[vary]]
quantity = "inertia_x"
uniform = { low = 0.8, high = 1.2 }
[[vary]]
quantity = "thrust"
log_normal = { deviation = 0.02 }
[[correlation]]
quantities = ["mass", "inertia_x"]
value = 0.6
[keep]
failures = 1
sample = 1
)";
  return {"campaign file",
          {{{{"c.toml", text},
             {"m.toml",
              "name = \"still\"\nduration_s = 0.2\n[start]\nat = \"air\"\nheight_m = "
              "1\n[hover]\nheight_m = 1\n[limits]\ntilt_max_rad = 0.5\n"}},
            "c.toml",
            Format::toml,
            {{"campaign", "run", "@/c.toml", "@/out"},
             {"campaign", "init", "@/c.toml", "@/out"},
             {"campaign", "init", "@/c.toml", "@/out", "--shards", "2"}}},
           {{{"c.toml", R"(name = "fitted"
vehicle = "mambo"
flights = 2
[[design]]
gains = "published"
[[mission]]
mission = "hover"
duration_s = 0.2
[[vary]]
quantity = "sonar_deviation"
fitted = { file = "tuned.toml", parameter = "R.sonar" }
)"},
             {"tuned.toml", with(tuned_altitude(), "unit = \"m2\"\nvariance = 0.1",
                                 "unit = \"m2\"\nvariance = 0.1\ninterval = [0.05, 0.2]")}},
            "c.toml",
            Format::toml,
            {{"campaign", "run", "@/c.toml", "@/out"}}}}};
}

Kind requirements() {
  const std::string text = R"([cost]
tracking_rms = 1
settling_time = 0.5
measure = "quantile"
quantile = 0.9
draws = 2
[margins]
Ms_max = 1.6
phase_margin_min_deg = 40
gain_margin_min_dB = 6
delay_margin_min_s = 0.01
[loops.pitch]
Ms_max = 1.5
[[mission]]
mission = "m.toml"
sensors = "ideal"
limits = { tilt_max_rad = 0.6 }
[[vary]]
quantity = "mass"
normal = { deviation = 0.03, least = 0.9, most = 1.1 }
[[vary]]
quantity = "thrust"
normal = { deviation = 0.03, least = 0.9, most = 1.1 }
[[correlation]]
quantities = ["mass", "thrust"]
value = 0.5
)";
  return {"requirements file",
          {{{{"r.toml", text},
             {"m.toml",
              "name = \"short\"\nduration_s = 6\n[start]\nat = \"air\"\nheight_m = "
              "1\n[[references]]\nat_s = 0\nheight_m = 1.2\n[settling]\nwindow_s = 1\n"}},
            "r.toml",
            Format::toml,
            {{"tune", "pid", "mambo", "--gains", "published", "--requirements", "@/r.toml",
              "--evaluations", "1", "--proof", "20"}}}}};
}

/// A log at rest, with a channel for every input of the built-in models and for some of their
/// outputs.
std::string resting_log_text() {
  const std::vector<std::pair<std::string, double>> channels = {
      {"ax", 0},      {"ay", 0},     {"flow_vx", 0}, {"flow_vy", 0}, {"rate", 0},    {"tilt", 0},
      {"gyro_x", 0},  {"gyro_y", 0}, {"gyro_z", 0},  {"force_x", 0}, {"force_y", 0}, {"force_z", 1},
      {"x", 0},       {"y", 0},      {"z", 0},       {"height", 1},  {"vx", 0},      {"vy", 0},
      {"vz", 0},      {"roll", 0},   {"pitch", 0},   {"yaw", 0},     {"fx", 0},      {"fy", 0},
      {"fz", -9.81},  {"p", 0},      {"q", 0},       {"r", 0},       {"px", 0},      {"py", 0},
      {"pz", 0},      {"u", 0},      {"v", 0},       {"w", 0},       {"speed_1", 1}, {"speed_2", 1},
      {"speed_3", 1}, {"speed_4", 1}};
  Random random(8);
  std::string text = "t_s";
  for (const auto& [name, mean] : channels) text += "," + name;
  for (int k = 0; k < 60; ++k) {
    text += fmt::format("\n{:.2f}", 0.02 * k);
    for (const auto& [name, mean] : channels) {
      const double size = name.starts_with("speed") ? 316.1 : name == "force_z" ? 9.81 : mean;
      text += fmt::format(",{:.4f}", size + 0.02 * random.noise());
    }
  }
  return text + "\n";
}

Kind filter_models() {
  Kind kind{"filter model"};
  const auto add = [&](const std::string& text, std::vector<Command> commands,
                       const std::string& log = small_log_text()) {
    Sample sample{{{"log.csv", log}}, "m.toml", Format::toml, std::move(commands)};
    sample.files["m.toml"] = text;
    kind.samples.push_back(std::move(sample));
  };
  const auto tune = [](Command more) {
    Command command = {"tune",  "kalman",    "--model",  "@/m.toml",
                       "--log", "@/log.csv", "--starts", "1"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  };
  add(project_file("filters/local-level.toml"),
      {tune({"--map", "y=y"}), tune({"--map", "y=y", "--method", "als"})});
  add(with(project_file("filters/local-level.toml"), "[[sensors]]", R"([initial]
x = [0]
variance = [10]
[[sensors]])"),
      {tune({"--map", "y=y", "--gate", "9"}), tune({"--map", "y=y", "--fix", "R.y"})});
  add(tuned_altitude(), {tune({}), tune({"-o", "@/tuned.toml", "--force"})});
  add(project_file("filters/constant-velocity.toml"), {tune({"--map", "position=height"})});
  kind.samples.push_back({{{"d.toml", kFilters}, {"tuned.toml", tuned_altitude()}},
                          "tuned.toml",
                          Format::toml,
                          {{"design", "@/d.toml", "--force"}}});
  for (const char* name : {"attitude", "velocity-xy", "inertial", "uquad"})
    add(project_file(std::string("filters/") + name + ".toml"), {tune({})}, resting_log_text());
  return kind;
}

}  // namespace

std::vector<Kind> written_kinds() {
  return {vehicles(),      designs(),      missions(),     mission_tables(),
          campaign_kind(), requirements(), filter_models()};
}

}  // namespace quadtune::mutations
