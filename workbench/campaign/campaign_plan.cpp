// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "campaign/setup_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/simulation/campaign/spread_uncertainty.hpp"
#include "quadtune/version.hpp"
#include "quadtune/workbench/campaign/campaign_file.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "quadtune/workbench/flight/option_of_file.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {
namespace {

using internal::finite_or_null;
using internal::Json;
using internal::member;

constexpr char kFormat[] = "quadtune campaign plan";
constexpr int kFormatVersion = 3;
constexpr char kPlanHashName[] = "plan.sha256";
constexpr std::size_t kPlanLimit = std::size_t{64} << 20;
/// Simulated time per shard if the file does not set the number of shards [s]: some minutes on one
/// processor.
constexpr double kShardTime = 3e6;

// --- the parts of a plan as JSON ---

double number_or(const Json& json, double fallback) {
  return json.is_null() ? fallback : json.get<double>();
}

Json to_json(const Uncertainty& uncertainty) {
  Json numbers = Json::array();
  for (const UncertainNumber& number : uncertainty.numbers) {
    const Distribution& d = number.distribution;
    numbers.push_back({{"quantity", number.quantity},
                       {"distribution", to_string(d.kind)},
                       {"first", d.first},
                       {"second", d.second},
                       {"least", finite_or_null(d.min)},
                       {"most", finite_or_null(d.max)}});
  }
  return {{"numbers", numbers},
          {"correlation", internal::matrix_to_json(uncertainty.correlation, "correlation")}};
}

Uncertainty uncertainty_of(const Json& json, const std::string& where) {
  Uncertainty uncertainty;
  for (const Json& entry : member(json, "numbers", where)) {
    UncertainNumber number;
    number.quantity = member(entry, "quantity", where).get<std::string>();
    const std::string kind = member(entry, "distribution", where).get<std::string>();
    Distribution& d = number.distribution;
    for (const DistributionKind known :
         {DistributionKind::normal, DistributionKind::uniform, DistributionKind::log_normal})
      if (to_string(known) == kind) d.kind = known;
    d.first = member(entry, "first", where).get<double>();
    d.second = member(entry, "second", where).get<double>();
    d.min = number_or(member(entry, "least", where), d.min);
    d.max = number_or(member(entry, "most", where), d.max);
    uncertainty.numbers.push_back(number);
  }
  uncertainty.correlation =
      internal::matrix_from_json(member(json, "correlation", where), where + ".correlation");
  return uncertainty;
}

Json to_json(const CascadeController& cascade) {
  Json loops = Json::array();
  for (const PidLoop& loop : cascade.gains.loops) {
    loops.push_back({{"name", loop.name}, {"Kp", loop.Kp}, {"Ki", loop.Ki}, {"Kd", loop.Kd}});
    if (loop.rate_lead == 0) continue;
    loops.back()["rate_lead"] = loop.rate_lead;
    loops.back()["rate_filter"] = loop.rate_filter;
  }
  return {{"dt_s", cascade.gains.dt},
          {"integrator", to_string(cascade.method)},
          {"attitude_limit", finite_or_null(cascade.attitude_limit)},
          {"integrator_limit", finite_or_null(cascade.integrator_limit)},
          {"back_calculation", cascade.back_calculation},
          {"velocity_feed_forward", cascade.velocity_feed_forward},
          {"conditional_integration", cascade.conditional_integration},
          {"loops", loops}};
}

CascadeController cascade_of(const Json& json, const std::string& where) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CascadeController cascade;
  cascade.gains.dt = member(json, "dt_s", where).get<double>();
  cascade.method = pid_method(member(json, "integrator", where).get<std::string>(), where);
  cascade.attitude_limit = number_or(member(json, "attitude_limit", where), kInfinity);
  cascade.integrator_limit = number_or(member(json, "integrator_limit", where), kInfinity);
  cascade.back_calculation = member(json, "back_calculation", where).get<double>();
  cascade.velocity_feed_forward = member(json, "velocity_feed_forward", where).get<bool>();
  cascade.conditional_integration = member(json, "conditional_integration", where).get<bool>();
  for (const Json& entry : member(json, "loops", where)) {
    PidLoop loop =
        cascade_loop(cascade_axis(member(entry, "name", where).get<std::string>(), where));
    loop.Kp = member(entry, "Kp", where).get<double>();
    loop.Ki = member(entry, "Ki", where).get<double>();
    loop.Kd = member(entry, "Kd", where).get<double>();
    if (entry.contains("rate_lead")) {
      loop.rate_lead = entry["rate_lead"].get<double>();
      loop.rate_filter = member(entry, "rate_filter", where).get<double>();
    }
    cascade.gains.loops.push_back(loop);
  }
  return cascade;
}

Json to_json(const WidenedLimit& widened) {
  return {{"what", widened.what},   {"label", widened.label}, {"unit", widened.unit},
          {"asked", widened.asked}, {"bound", widened.bound}, {"judged", widened.judged}};
}
WidenedLimit widened_of(const Json& json, const std::string& where) {
  const auto word = [&](const char* key) { return member(json, key, where).get<std::string>(); };
  const auto number = [&](const char* key) { return member(json, key, where).get<double>(); };
  return {word("what"),    word("label"),   word("unit"),
          number("asked"), number("bound"), number("judged")};
}

/// A planned flight: its setup and the description of its choices. Law, vehicle and mission text
/// are stored elsewhere in the plan.
Json to_json(const PlannedFlight& flight) {
  Json widened = Json::array();
  for (const WidenedLimit& limit : flight.widened) widened.push_back(to_json(limit));
  return {{"estimator", flight.estimator},
          {"sensors", flight.sensors},
          {"wind", flight.wind},
          {"notes", flight.notes},
          {"widened", widened},
          {"filter_of_the_law", flight.setup.general_filter.has_value()},
          {"setup", internal::setup_to_json(flight.setup)}};
}

/// The inverse.
PlannedFlight flight_of(const Json& json, const std::string& where, const Vehicle& vehicle,
                        const Mission& mission, const ChosenLaw& law) {
  PlannedFlight flight;
  flight.law = law.words;
  flight.estimator = member(json, "estimator", where).get<std::string>();
  flight.sensors = member(json, "sensors", where).get<std::string>();
  flight.wind = member(json, "wind", where).get<std::string>();
  for (const Json& note : member(json, "notes", where))
    flight.notes.push_back(note.get<std::string>());
  for (const Json& limit : member(json, "widened", where))
    flight.widened.push_back(widened_of(limit, where));
  FlightSetup& setup = flight.setup;
  setup.vehicle = vehicle;
  setup.mission = mission;
  setup.controller = law.controller;
  if (member(json, "filter_of_the_law", where).get<bool>()) {
    if (!law.estimator || !law.estimator->general)
      throw InvalidInput(where, "a flight uses the filter of its law, but the law has none");
    setup.general_filter = law.estimator->general;
  }
  internal::setup_from_json(member(json, "setup", where), where, setup);
  validate(setup);
  return flight;
}

// --- making a plan ---

void add_case(const std::string& design, const std::string& mission, PlannedFlight flight,
              CampaignPlan& plan) {
  plan.campaign.cases.push_back({design, mission, std::move(flight.setup)});
  flight.setup = {};
  plan.words.push_back(std::move(flight));
}

/// The vehicle of a request; an unknown name is an error in the file.
Vehicle vehicle_of(const CampaignRequest& request) {
  try {
    return load_vehicle(request.vehicle);
  } catch (const InvalidInput& error) {
    if (error.where() == "vehicle") throw InvalidInput(request.vehicle_where, error.what());
    throw;
  }
}

/// Rejects an unstable design before thousands of flights crash.
void require_stable(const PlannedFlight& plan, const CampaignDesign& design) {
  const std::optional<FlownLoop> loop = hover_loop(plan);
  if (!loop || !loop->grows()) return;
  throw NoSolution(
      fmt::format("{}: the design '{}' does not stabilize the vehicle '{}' in flight with the "
                  "estimator {}: {}; {}",
                  design.where, design.name, plan.setup.vehicle.name, plan.estimator,
                  describe(*loop), what_helps(plan, *loop)),
      design.where);
}

class PlanMaker {
 public:
  PlanMaker(const std::filesystem::path& file, std::uint32_t shards,
            const std::optional<std::uint64_t>& seed)
      : file_(file.string()), request_(read_campaign(file)), shards_(shards) {
    request_.seed = seed.value_or(request_.seed);
  }

  MadeCampaign make() {
    const Vehicle vehicle = vehicle_of(request_);
    add_spread(vehicle, request_.uncertainty);
    CampaignPlan& plan = made_.plan;
    plan.name = request_.name;
    plan.shards = shard_count();
    plan.keep = request_.keep;
    plan.campaign.flights = request_.flights;
    plan.campaign.seed = request_.seed;
    plan.campaign.uncertainty = request_.uncertainty;
    Json json = {{"format", kFormat},
                 {"format_version", kFormatVersion},
                 {"version", std::string(kVersion)},
                 {"name", request_.name},
                 {"flights", request_.flights},
                 {"seed", request_.seed},
                 {"shards", plan.shards},
                 {"keep", {{"failures", request_.keep.failures}, {"sample", request_.keep.sample}}},
                 {"uncertainty", to_json(request_.uncertainty)},
                 {"vehicle", {{"origin", request_.vehicle}, {"text", vehicle.text}}}};
    add_missions(json);
    json["designs"] = Json::array();
    json["cases"] = Json::array();
    for (const CampaignDesign& design : request_.designs) add_design(json, design, vehicle);
    json["inputs"] = Json::array();
    for (const FileContent& file : made_.files)
      json["inputs"].push_back({{"file", file.name}, {"sha256", sha256(file.bytes)}});
    const std::string text = internal::readable(json) + "\n";
    plan.hash = sha256(text);
    made_.files.push_back({kPlanName, text});
    made_.files.push_back({kPlanHashName, plan.hash + "\n"});
    validate(plan.campaign, file_);
    return std::move(made_);
  }

 private:
  std::uint32_t shard_count() const {
    std::uint32_t shards = shards_ > 0 ? shards_ : request_.shards;
    if (shards == 0) {
      double time = 0;  // for one draw
      for (const CampaignMission& m : request_.missions)
        time += m.arguments.duration.value_or(m.mission.duration);
      time *= static_cast<double>(request_.flights * request_.designs.size());
      shards = static_cast<std::uint32_t>(
          std::clamp(std::ceil(time / kShardTime), 1.0, static_cast<double>(request_.flights)));
    }
    if (shards > request_.flights)
      throw OptionError("shards", fmt::format("shards is {}, expected at most {}, the number "
                                              "of draws in the campaign file (flights)",
                                              shards, request_.flights));
    return shards;
  }

  void add_missions(Json& json) {
    json["missions"] = Json::array();
    for (const CampaignMission& m : request_.missions) {
      Json entry = {{"name", m.mission.name}, {"text", m.mission.text}};
      const auto table = internal::TomlTable::parse(m.mission.text, m.mission.name);
      if (const auto csv = table.maybe_table("csv")) {
        // The file of its references is next to the mission; in the plan, it is next to the plan.
        const std::string name = csv->word("file");
        const std::string bytes =
            internal::read_file((m.mission.file.parent_path() / name).string(), kScriptFileLimit);
        for (const FileContent& file : made_.files)
          if (file.name == name && file.bytes != bytes)
            throw InvalidInput(m.where, fmt::format("the references '{}' are used by "
                                                    "another mission; rename one of the files",
                                                    name));
        if (std::none_of(made_.files.begin(), made_.files.end(),
                         [&](const FileContent& file) { return file.name == name; }))
          made_.files.push_back({name, bytes});
      }
      json["missions"].push_back(std::move(entry));
    }
  }

  /// The law does not depend on the mission, but the planned flight does.
  void add_design(Json& json, const CampaignDesign& design, const Vehicle& vehicle) {
    Json entry = {{"name", design.name}};
    FlightOptions arguments;
    arguments.vehicle = request_.vehicle;
    arguments.gains = design.gains;
    arguments.controller = design.controller;
    arguments.integrator = design.integrator;
    const ChosenLaw law =
        option_of_file(design.where, [&] { return choose_law(arguments, vehicle, "campaign"); });
    if (law.on_board)
      throw InvalidInput(design.where + ": controller",
                         fmt::format("{} has the loops of an autopilot, which campaigns do not "
                                     "support; use controller = \"cascaded-pid\", the cascade "
                                     "that approximates them",
                                     design.gains));
    entry["law"] = law.words;
    Controller controller = law.controller;
    if (law.estimator) {
      ExportContent content;
      content.vehicle = vehicle;
      content.estimator = law.estimator;
      const std::string name = fmt::format("estimator-{}.json", design.name);
      entry["estimator"] = name;
      made_.files.push_back({name, gains_json_text(content)});
    }
    for (const CampaignMission& m : request_.missions) {
      FlightOptions flown = m.arguments;
      flown.integrator = design.integrator;
      PlannedFlight plan =
          option_of_file(m.where, [&] { return plan_flight(flown, vehicle, m.mission, law); });
      require_stable(plan, design);
      controller = plan.setup.controller;  // with the requested integrator
      Json flight = to_json(plan);
      flight["design"] = design.name;
      flight["mission"] = m.mission.name;
      json["cases"].push_back(std::move(flight));
      add_case(design.name, m.mission.name, std::move(plan), made_.plan);
    }
    if (const auto* cascade = std::get_if<CascadeController>(&controller)) {
      entry["cascade"] = to_json(*cascade);
    } else {
      const auto& feedback = std::get<StateFeedbackController>(controller);
      ExportContent content;
      content.vehicle = vehicle;
      content.gains = feedback.gains;
      const std::string name = fmt::format("gains-{}.json", design.name);
      entry["gains"] = name;
      entry["dt_s"] = feedback.dt;
      made_.files.push_back({name, gains_json_text(content)});
      if (feedback.schedule) {
        const std::string table = fmt::format("schedule-{}.json", design.name);
        entry["schedule"] = table;
        made_.files.push_back({table, schedule_text(*feedback.schedule, TableFormat::json)});
      }
    }
    json["designs"].push_back(std::move(entry));
  }

  std::string file_;
  CampaignRequest request_;
  std::uint32_t shards_;
  MadeCampaign made_;
};

// --- reading it back ---

Json parse_plan(const std::string& text, const std::string& where) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const internal::JsonError&) {
    throw InvalidInput(
        where,
        "is not the plan of a campaign: it is not JSON; expected a plan that `campaign init` "
        "wrote");
  }
  if (!json.is_object() || !json.contains("format") || json["format"] != kFormat)
    throw InvalidInput(where,
                       "is not the plan of a campaign; expected a plan that `campaign init` wrote");
  if (!json.contains("version") || json["version"] != std::string(kVersion) ||
      !json.contains("format_version") || json["format_version"] != kFormatVersion)
    throw InvalidInput(
        where,
        fmt::format("was written by version {}, but this is {}; use the same version, because "
                    "results may differ between versions",
                    json.contains("version") ? internal::json_text(json["version"]) : "\"\"",
                    kVersion));
  return json;
}

void check_inputs(const Json& json, const std::filesystem::path& folder, const std::string& where) {
  const Json& inputs = member(json, "inputs", where);
  if (!inputs.is_array())
    throw InvalidInput(where, "has been modified since it was written: inputs is not a list");
  for (const Json& input : inputs) {
    const auto name = member(input, "file", where).get<std::string>();
    const std::string path = (folder / std::filesystem::path(name).filename()).string();
    if (sha256_of_file(path) != member(input, "sha256", where).get<std::string>())
      throw InvalidInput(path,
                         "has been modified since the plan was written; restore it, or "
                         "start the changed campaign in a new folder");
  }
}

/// A non-negative integer of the plan; a plain conversion would turn -1.5 into four billion.
std::uint32_t count_of(const Json& json, const char* key, std::uint32_t min, std::uint32_t max,
                       const std::string& where) {
  const Json& value = member(json, key, where);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() < min ||
      value.get<std::uint64_t>() > max)
    throw InvalidInput(where,
                       fmt::format("has been modified since it was written: {} is {}, expected {} "
                                   "to {}",
                                   key, internal::json_text(value), min, max));
  return value.get<std::uint32_t>();
}

struct NamedLaw {
  std::string name;
  ChosenLaw law;
};

/// The law or mission with a name.
template <class Item>
const Item& named(const std::vector<Item>& items, const std::string& name,
                  const std::string& where) {
  for (const Item& item : items)
    if (item.name == name) return item;
  throw InvalidInput(where, fmt::format("cases has '{}', which is not in the plan", name));
}

CampaignPlan plan_of(const Json& json, const std::filesystem::path& folder,
                     const std::string& where) {
  constexpr std::uint32_t kMax = std::numeric_limits<std::int32_t>::max();
  CampaignPlan plan;
  plan.name = member(json, "name", where).get<std::string>();
  const Json& keep = member(json, "keep", where);
  plan.keep = {static_cast<int>(count_of(keep, "failures", 0, kMax, where)),
               static_cast<int>(count_of(keep, "sample", 0, kMax, where))};
  Campaign& campaign = plan.campaign;
  campaign.flights = count_of(json, "flights", 1, kMax, where);
  plan.shards = count_of(json, "shards", 1, campaign.flights, where);
  campaign.seed = count_of(json, "seed", 0, kMax, where);
  campaign.uncertainty = uncertainty_of(member(json, "uncertainty", where), where);
  const Json& body = member(json, "vehicle", where);
  const Vehicle vehicle = parse_vehicle(member(body, "text", where).get<std::string>(),
                                        member(body, "origin", where).get<std::string>());
  std::vector<NamedLaw> laws;
  for (const Json& design : member(json, "designs", where)) {
    ChosenLaw law;
    law.words = member(design, "law", where).get<std::string>();
    if (design.contains("cascade"))
      law.controller = cascade_of(design["cascade"], where);
    else if (design.contains("schedule"))
      law.controller = scheduled_controller(
          vehicle, read_schedule(folder / design["schedule"].get<std::string>()),
          member(design, "dt_s", where).get<double>());
    else
      law.controller = feedback_controller(
          read_gains(folder / member(design, "gains", where).get<std::string>()),
          member(design, "dt_s", where).get<double>());
    if (design.contains("estimator"))
      law.estimator = read_laws(folder / design["estimator"].get<std::string>()).estimator;
    laws.push_back({member(design, "name", where).get<std::string>(), std::move(law)});
  }
  std::vector<Mission> missions;
  for (const Json& mission : member(json, "missions", where))
    missions.push_back(parse_mission(member(mission, "text", where).get<std::string>(),
                                     member(mission, "name", where).get<std::string>(), folder));
  for (const Json& flight : member(json, "cases", where)) {
    const auto design = member(flight, "design", where).get<std::string>();
    const auto mission = member(flight, "mission", where).get<std::string>();
    add_case(design, mission,
             flight_of(flight, where, vehicle, named(missions, mission, where),
                       named(laws, design, where).law),
             plan);
  }
  return plan;
}

}  // namespace

MadeCampaign make_campaign(const std::filesystem::path& file, std::uint32_t shards,
                           const std::optional<std::uint64_t>& seed) {
  return PlanMaker(file, shards, seed).make();
}

CampaignPlan load_plan(const std::filesystem::path& folder) {
  const std::string path = (folder / kPlanName).string();
  const std::string text = internal::read_text_file(path, kPlanLimit);
  const Json json = parse_plan(text, path);
  const std::string written =
      internal::read_text_file((folder / kPlanHashName).string(), std::size_t{1} << 10);
  if (written != sha256(text) + "\n")
    throw InvalidInput(path,
                       "has been modified since it was written; restore it, or start the "
                       "changed campaign in a new folder");
  try {
    check_inputs(json, folder, path);
    CampaignPlan plan = plan_of(json, folder, path);
    plan.hash = sha256(text);
    validate(plan.campaign, path);
    return plan;
  } catch (const internal::JsonError&) {
    throw InvalidInput(path,
                       "has been modified since it was written: a value has another "
                       "type than `campaign init` writes");
  }
}

CampaignFolder folder_of(const CampaignPlan& plan, const std::filesystem::path& folder) {
  return {folder, plan.hash, plan.campaign.flights,
          static_cast<std::uint32_t>(plan.campaign.cases.size()), plan.shards};
}

}  // namespace quadtune
