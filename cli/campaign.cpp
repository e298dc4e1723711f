// SPDX-License-Identifier: Apache-2.0
/// quadtune campaign: many flights with drawn parameters, on one machine or on many.
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "arguments/flight_arguments.hpp"
#include "arguments/flight_outputs.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/progress.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "quadtune/workbench/campaign/campaign_merge.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/campaign/campaign_run.hpp"
#include "report/flights/flights.hpp"

namespace quadtune::cli {
namespace {

namespace fs = std::filesystem;

/// The options of all campaign commands; each command has some of them.
struct Options {
  std::string file, folder;
  std::uint64_t shards = 0, shard = 0, flight = 0;
  FlightOutputs outputs;
};

void need(const std::string& word, const char* what, const char* expected) {
  if (word.empty()) refuse(what, "expected {}", expected);
}

CampaignWatch watched(Progress& progress) {
  return {[&progress](const CampaignProgress& now) {
            progress.show(progress_line(now, progress.seconds()));
          },
          {},
          interrupted};
}

/// Converts the value of --shards.
std::uint32_t shard_count(std::uint64_t shards) {
  constexpr std::uint32_t kMax = std::numeric_limits<std::uint32_t>::max();
  if (shards > kMax)
    refuse("--shards", "--shards is {}, expected at most the number of flights", shards);
  return static_cast<std::uint32_t>(shards);
}

/// Makes a plan and writes it into the folder.
/// @return  whether the folder already contained this plan
bool write_plan(const CommandLine& line, const Options& options, const Context& context) {
  const std::optional<std::uint64_t> seed =
      line.was_given("--seed") ? std::optional(context.seed) : std::nullopt;
  const MadeCampaign made = make_campaign(options.file, shard_count(options.shards), seed);
  const WritingFiles writing;
  return write_campaign(made, options.folder, interrupted);
}

/// Loads the plan of a folder, whose seed no option changes.
CampaignPlan planned(const CommandLine& line, const std::string& folder) {
  line.refuse_given(
      {"--seed"},
      "has no effect, because the plan contains the seed; expected it in `campaign init`");
  return load_plan(folder);
}

/// Prints the notes that `fly` would print for these flights.
void note_words(const CampaignPlan& plan, const Context& context) {
  for (const PlannedFlight& words : plan.words) context.notes("note: ", words.notes);
}

void note_damage(std::uint32_t shard, const ShardWork& work, const Context& context) {
  for (const std::string& damage : work.damage)
    context.note(fmt::format("shard {}: {}: flown again", shard, damage));
}

// --- what each verb does ---

void init(const CommandLine& line, Options& options, Context& context) {
  need(options.file, "FILE", "a campaign file and a folder");
  need(options.folder, "DIR", "a folder for the plan");
  const bool was_there = write_plan(line, options, context);
  const CampaignPlan plan = load_plan(options.folder);
  note_words(plan, context);
  context.print([&] { return to_json(plan); },
                [&] { return to_text(plan, options.folder, was_there); });
}

void work(const CommandLine& line, Options& options, Context& context) {
  need(options.folder, "DIR", "a folder with a plan");
  if (!line.was_given("--shard"))
    refuse("--shard", "--shard is missing, expected the number of the shard to fly");
  const CampaignPlan plan = planned(line, options.folder);
  if (options.shard >= plan.shards)
    refuse("--shard", "--shard is {}, expected 0 to {}", options.shard, plan.shards - 1);
  const auto shard = static_cast<std::uint32_t>(options.shard);
  ShardWork done;
  {
    Progress progress(context);
    done = fly_campaign_shard(plan, options.folder, shard, context.threads, watched(progress));
  }
  note_damage(shard, done, context);
  context.print([&] { return to_json(shard, done); }, [&] { return to_text(shard, done); });
}

void status(const CommandLine& line, Options& options, Context& context) {
  need(options.folder, "DIR", "a folder with a plan");
  const CampaignPlan plan = planned(line, options.folder);
  const CampaignStatus status = campaign_status(plan, options.folder);
  context.print([&] { return to_json(plan, status); }, [&] { return to_text(plan, status); });
}

/// Writes flights.csv, campaign.sqlite, statistics.json, report.html and the logs that are kept.
void merge_plan(const CampaignPlan& plan, const std::string& folder, Context& context) {
  const MergedCampaign merged = merge_campaign(plan, folder, context.threads, interrupted);
  std::vector<std::string> files;
  const auto write = [&](const std::string& file, const std::string& bytes) {
    context.write(file, bytes);
    files.push_back(file);
  };
  {
    const WritingFiles writing;
    files = write_campaign_tables(plan, merged, folder, context.threads, interrupted);
  }
  for (const std::string& table : files) context.written.push_back(table);
  internal::Json json = to_json(plan, merged.statistics, folder);
  write((fs::path(folder) / "statistics.json").string(), internal::readable(json) + "\n");
  write((fs::path(folder) / "report.html").string(),
        campaign_html(plan, merged.statistics, merged.records, folder));
  for (const std::uint64_t number : kept_flights(plan, merged.records)) {
    const FileContent log = campaign_log(plan, folder, number, interrupted);
    write(log.name, log.bytes);
  }
  context.print(
      [&] {
        json["files"] = files;
        return json;
      },
      [&] {
        return fmt::format("{}\nwritten: {}\n", to_text(plan, merged.statistics, folder),
                           internal::joined(files, " "));
      });
}

void merge(const CommandLine& line, Options& options, Context& context) {
  need(options.folder, "DIR", "a folder with flown shards");
  merge_plan(planned(line, options.folder), options.folder, context);
}

void run_campaign(const CommandLine& line, Options& options, Context& context) {
  need(options.file, "FILE", "a campaign file");
  const bool unnamed = options.folder.empty();
  if (unnamed) options.folder = fs::path(options.file).stem().string() + "-campaign";
  (void)write_plan(line, options, context);
  if (unnamed)
    context.note(fmt::format("note: plan, flights and tables are written to {}", options.folder));
  const CampaignPlan plan = load_plan(options.folder);
  note_words(plan, context);
  {
    Progress progress(context);
    CampaignWatch watch = watched(progress);
    watch.shard_done = [&](std::uint32_t shard, const ShardWork& done) {
      note_damage(shard, done, context);
    };
    fly_campaign(plan, options.folder, context.threads, watch);
  }
  merge_plan(plan, options.folder, context);
}

void replay(const CommandLine& line, Options& options, Context& context) {
  need(options.folder, "DIR", "a folder with a plan");
  if (!line.was_given("--flight"))
    refuse("--flight", "--flight is missing, expected a flight's number");
  const CampaignPlan plan = planned(line, options.folder);
  if (options.flight >= plan.campaign.records())
    refuse("--flight", "--flight is {}, expected 0 to {}", options.flight,
           plan.campaign.records() - 1);
  require_output_names(options.outputs);
  PlannedFlight flight = replayed_flight(plan, options.flight);
  keep_log_for(options.outputs, flight);
  tell_flight(fly_planned(std::move(flight), interrupted), std::nullopt, options.outputs, context);
}

// --- their options ---

constexpr char kPlanned[] = "the folder into which `campaign init` wrote the plan";

void add_init_options(CommandLine& line, Options& options) {
  line.add_option("FILE", options.file, "a campaign file (docs/formats.md)");
  line.add_option("DIR", options.folder, "a new folder");
  line.add_count(
      "--shards N", options.shards, 1,
      "number of parts for the workers; default: `shards` of the campaign file, or so many that "
      "each takes a few minutes");
}

void add_work_options(CommandLine& line, Options& options) {
  line.add_option("DIR", options.folder, kPlanned);
  line.add_count("--shard K", options.shard, 0, "index of the part, from 0");
}

void add_status_options(CommandLine& line, Options& options) {
  line.add_option("DIR", options.folder, kPlanned);
}

void add_merge_options(CommandLine& line, Options& options) {
  line.add_option("DIR", options.folder, "the folder in which all shards have been flown");
}

void add_run_options(CommandLine& line, Options& options) {
  line.add_option("FILE", options.file, "a campaign file (docs/formats.md)");
  line.add_option("DIR", options.folder,
                  "a new folder, or that of an interrupted run; default: the file's name followed "
                  "by -campaign, in this folder");
  line.add_count("--shards N", options.shards, 1, "as for `campaign init`");
}

void add_replay_options(CommandLine& line, Options& options) {
  line.add_option("DIR", options.folder, kPlanned);
  line.add_count("--flight N", options.flight, 0, "number of the flight in flights.csv");
  add_flight_outputs(line, options.outputs);
}

}  // namespace

std::vector<Verb> campaign_verbs() {
  return {{"campaign init", "FILE DIR [--shards N]",
           "plan many flights: cases, uncertain parameters, number of parts",
           "quadtune campaign init campaigns/mambo-hover.toml out/campaign",
           with_options(add_init_options, init)},
          {"campaign work", "DIR --shard K",
           "fly one part of a campaign, or continue it after an interruption",
           "quadtune campaign work out/campaign --shard 0", with_options(add_work_options, work)},
          {"campaign status", "DIR", "show the progress of a campaign, shard by shard",
           "quadtune campaign status out/campaign", with_options(add_status_options, status)},
          {"campaign merge", "DIR", "merge the flights of a campaign: database, statistics, page",
           "quadtune campaign merge out/campaign", with_options(add_merge_options, merge)},
          {"campaign run", "FILE [DIR]", "plan, fly and merge a campaign on this machine",
           "quadtune campaign run campaigns/mambo-hover.toml out/campaign",
           with_options(add_run_options, run_campaign)},
          {"campaign replay", "DIR --flight N [--report FILE] [--log FILE]",
           "fly one flight of a campaign again, with log and report",
           "quadtune campaign replay out/campaign --flight 4 --report out/flight-4.html",
           with_options(add_replay_options, replay)}};
}

}  // namespace quadtune::cli
