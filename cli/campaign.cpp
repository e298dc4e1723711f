// SPDX-License-Identifier: Apache-2.0
/// quadtune campaign: many flights with what is uncertain drawn for each, on one machine or many.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "campaign/campaign_merge.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "quadtune/workbench/campaign/campaign_folder.hpp"
#include "quadtune/workbench/campaign/campaign_plan.hpp"
#include "quadtune/workbench/campaign/campaign_scripts.hpp"
#include "report/flights/campaign_report.hpp"
#include "report/flights/campaign_status.hpp"
#include "report/flights/flight_story.hpp"

namespace quadtune::cli {
namespace {

namespace fs = std::filesystem;
using internal::Json;

[[noreturn]] void refuse(const char* verb, const std::string& option, const std::string& why) {
  throw UsageError(fmt::format("quadtune campaign {}: {}", verb, why), option);
}

void need(const std::string& word, const char* verb, const char* what, const char* expected) {
  if (word.empty()) refuse(verb, what, fmt::format("expected {}", expected));
}

/// One line that is written over while work goes on; on a terminal only.
class Progress {
 public:
  explicit Progress(const Context& context)
      : shown_(!context.quiet && !context.json && isatty(STDERR_FILENO) != 0),
        err_(context.err),
        begin_(std::chrono::steady_clock::now()) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (drawn_) err_ << "\r\033[K" << std::flush;
  }

  /// @param flown    since the beginning, > 0
  /// @param missing  yet to be flown
  /// @param all      these, and what was there already; > 0
  void show(std::uint64_t flown, std::uint64_t missing, std::uint64_t all) {
    if (!shown_) return;
    const double passed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    const double left = passed / static_cast<double>(flown) * static_cast<double>(missing);
    const std::uint64_t done = all - missing;
    constexpr std::size_t kWidth = 30;
    const auto filled = static_cast<std::size_t>(kWidth * done / all);
    err_ << fmt::format("\r\033[K[{:#<{}}{:.<{}}] {} of {} flights, {:.0f} s left", "", filled, "",
                        kWidth - filled, done, all, left)
         << std::flush;
    drawn_ = true;
  }

 private:
  bool shown_, drawn_ = false;
  std::ostream& err_;
  std::chrono::steady_clock::time_point begin_;
};

/// Plans, and writes the plan into the folder.
/// @return  whether it was there already
bool init(const std::string& file, const std::string& folder, std::uint32_t shards) {
  const MadeCampaign made =
      option_of_command("campaign", [&] { return make_campaign(file, shards); });
  const WritingFiles writing;
  return write_campaign(made, folder, interrupted);
}

/// --shards as it is counted.
std::uint32_t shard_count(std::uint64_t shards, const char* verb) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  if (shards > kMost)
    refuse(verb, "--shards",
           fmt::format("--shards is {}, expected at most as many as there are flights", shards));
  return static_cast<std::uint32_t>(shards);
}

/// What `fly` would say of these flights.
void note_words(const CampaignPlan& plan, const Context& context) {
  for (const PlannedFlight& words : plan.words)
    for (const std::string& note : words.notes) context.note("campaign: note: " + note);
}

void note_damage(const ShardWork& work, std::uint32_t shard, const Context& context) {
  for (const std::string& damage : work.damage)
    context.note(fmt::format("campaign: shard {}: {}: flown again", shard, damage));
}

// --- verbs ---

Verb init_verb() {
  struct Options {
    std::string file, folder;
    std::uint64_t shards = 0;
  };
  return {"campaign init", "FILE DIR [--shards N]",
          "plan many flights: what flies, what is uncertain, in how many parts",
          "quadtune campaign init campaigns/mambo-hover.toml out/campaign",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("FILE", options->file, "a campaign file (docs/formats.md)");
            line.add_option("DIR", options->folder, "a new folder");
            line.add_count("--shards", options->shards, 1,
                           "parts that workers fly; as many as take some minutes each")
                ->type_name("N");
            return [options](Context& context) {
              need(options->file, "init", "FILE", "a campaign file and a folder");
              need(options->folder, "init", "DIR", "a folder for the plan");
              const bool there =
                  init(options->file, options->folder, shard_count(options->shards, "init"));
              const CampaignPlan plan = load_plan(options->folder);
              const Campaign& campaign = plan.campaign;
              note_words(plan, context);
              if (context.json) {
                context.out << internal::readable(Json{{"name", plan.name},
                                                       {"sha256", plan.hash},
                                                       {"flights", campaign.flights},
                                                       {"cases", campaign.cases.size()},
                                                       {"records", campaign.records()},
                                                       {"shards", plan.shards}})
                            << "\n";
                return;
              }
              context.out << fmt::format(
                  "{}: {} draws in {} case{}, {} shard{}{}\n", plan.name, campaign.flights,
                  campaign.cases.size(), campaign.cases.size() == 1 ? "" : "s", plan.shards,
                  plan.shards == 1 ? "" : "s", there ? "; the plan was there already" : "");
              for (std::size_t i = 0; i < campaign.cases.size(); ++i)
                context.out << fmt::format("  {} in {}: {}; {}\n", campaign.cases[i].design,
                                           campaign.cases[i].mission, plan.words[i].law,
                                           surroundings(plan.words[i]));
              context.out << fmt::format(
                  "fly it: {0}/parallel.sh here or over ssh, sbatch {0}/slurm.sh on a cluster, or\n"
                  "        quadtune campaign work {0} --shard 0 and so on; then\n"
                  "        quadtune campaign merge {0}\n",
                  options->folder);
            };
          }};
}

Verb work_verb() {
  struct Options {
    std::string folder;
    std::uint64_t shard = 0;
    Option* given = nullptr;
  };
  return {
      "campaign work", "DIR --shard K", "fly one part of a campaign; again where it was stopped",
      "quadtune campaign work out/campaign --shard 0", [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("DIR", options->folder, "where `campaign init` wrote the plan");
        options->given =
            line.add_count("--shard", options->shard, 0, "the part, from 0")->type_name("K");
        return [options](Context& context) {
          need(options->folder, "work", "DIR", "a folder with a plan");
          if (!options->given->was_given())
            refuse("work", "--shard", "--shard is missing, expected the part to fly");
          const CampaignPlan plan = load_plan(options->folder);
          if (options->shard >= plan.shards)
            refuse("work", "--shard",
                   fmt::format("--shard is {}, expected 0 to {}", options->shard, plan.shards - 1));
          const auto shard = static_cast<std::uint32_t>(options->shard);
          const CampaignFolder folder = folder_of(plan, options->folder);
          const DrawRange draws = shard_draws(plan.campaign.flights, plan.shards, shard);
          const std::uint64_t all = std::uint64_t{draws.end - draws.begin} * folder.cases;
          ShardWork work;
          {
            Progress progress(context);
            work = fly_shard(
                plan.campaign, folder, shard, context.threads,
                [&](std::uint64_t flown, std::uint64_t missing) {
                  progress.show(flown, missing, all);
                },
                interrupted);
          }
          note_damage(work, shard, context);
          if (context.json)
            context.out << internal::readable(Json{{"shard", shard},
                                                   {"was_complete", work.was_complete},
                                                   {"found", work.found},
                                                   {"flown", work.flown},
                                                   {"damage", work.damage}})
                        << "\n";
          else
            context.out << (work.was_complete
                                ? fmt::format("shard {} was complete: {} flights, verified\n",
                                              shard, work.found)
                                : fmt::format("shard {}: {} flown, {} found\n", shard, work.flown,
                                              work.found));
        };
      }};
}

Verb status_verb() {
  struct Options {
    std::string folder;
  };
  return {"campaign status", "DIR", "how far a campaign is, shard by shard",
          "quadtune campaign status out/campaign", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("DIR", options->folder, "where `campaign init` wrote the plan");
            return [options](Context& context) {
              need(options->folder, "status", "DIR", "a folder with a plan");
              const CampaignPlan plan = load_plan(options->folder);
              const CampaignStatus status = campaign_status(plan, options->folder);
              context.out << (context.json ? internal::readable(to_json(plan, status)) + "\n"
                                           : to_text(plan, status));
            };
          }};
}

void tell(const CampaignPlan& plan, const MergedCampaign& merged, const std::string& folder,
          Context& context) {
  if (context.json) {
    Json json = to_json(plan, merged.statistics, folder);
    json["files"] = merged.files;
    context.out << internal::readable(json) << "\n";
    return;
  }
  context.out << to_text(plan, merged.statistics, folder) << "\nwritten:";
  for (const std::string& file : merged.files) context.out << " " << file;
  context.out << "\n";
}

Verb merge_verb() {
  struct Options {
    std::string folder;
  };
  return {"campaign merge", "DIR", "put a campaign's flights together: database, statistics, page",
          "quadtune campaign merge out/campaign", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("DIR", options->folder, "where all shards were flown");
            return [options](Context& context) {
              need(options->folder, "merge", "DIR", "a folder with flown shards");
              const CampaignPlan plan = load_plan(options->folder);
              tell(plan, merge_campaign(plan, options->folder, context), options->folder, context);
            };
          }};
}

Verb run_verb() {
  struct Options {
    std::string file, folder;
    std::uint64_t shards = 0;
  };
  return {"campaign run", "FILE [DIR]", "plan, fly and merge a campaign on this machine",
          "quadtune campaign run campaigns/mambo-hover.toml out/campaign",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("FILE", options->file, "a campaign file (docs/formats.md)");
            line.add_option("DIR", options->folder,
                            "a new folder, or one where this was stopped; if absent the file's "
                            "name with -campaign, here");
            line.add_count("--shards", options->shards, 1, "as `campaign init`")->type_name("N");
            return [options](Context& context) {
              need(options->file, "run", "FILE", "a campaign file");
              const bool unnamed = options->folder.empty();
              if (unnamed) options->folder = fs::path(options->file).stem().string() + "-campaign";
              (void)init(options->file, options->folder, shard_count(options->shards, "run"));
              if (unnamed)
                context.note(fmt::format("campaign run: note: plan, flights and tables go into {}",
                                         options->folder));
              const CampaignPlan plan = load_plan(options->folder);
              note_words(plan, context);
              const CampaignFolder folder = folder_of(plan, options->folder);
              const std::uint64_t all = plan.campaign.records();
              std::uint64_t missing = all, before = 0;  // before: flown here, of earlier shards
              for (std::uint32_t shard = 0; shard < plan.shards; ++shard)
                missing -= shard_state(folder, shard).records;
              {
                Progress progress(context);
                for (std::uint32_t shard = 0; shard < plan.shards; ++shard) {
                  const ShardWork work = fly_shard(
                      plan.campaign, folder, shard, context.threads,
                      [&](std::uint64_t flown, std::uint64_t) {
                        // A worker beside this one may have flown, or lost, some of them since.
                        const std::uint64_t together = before + flown;
                        progress.show(together, missing - std::min(missing, together), all);
                      },
                      interrupted);
                  note_damage(work, shard, context);
                  before += work.flown;
                }
              }
              tell(plan, merge_campaign(plan, options->folder, context), options->folder, context);
            };
          }};
}

Verb replay_verb() {
  struct Options {
    std::string folder, log, report;
    std::uint64_t flight = 0;
    Option* given = nullptr;
  };
  return {"campaign replay", "DIR --flight N [--report FILE] [--log FILE]",
          "fly one flight of a campaign again and look at it",
          "quadtune campaign replay out/campaign --flight 4 --report out/flight-4.html",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("DIR", options->folder, "where `campaign init` wrote the plan");
            options->given =
                line.add_count("--flight", options->flight, 0, "its number in flights.csv")
                    ->type_name("N");
            line.add_option("--log", options->log, "write every period to a .csv or .mat file")
                ->type_name("FILE");
            line.add_option("--report", options->report, "write a page to look at: a .html file")
                ->type_name("FILE");
            return [options](Context& context) {
              need(options->folder, "replay", "DIR", "a folder with a plan");
              if (!options->given->was_given())
                refuse("replay", "--flight", "--flight is missing, expected a flight's number");
              const CampaignPlan plan = load_plan(options->folder);
              if (options->flight >= plan.campaign.records())
                refuse("replay", "--flight",
                       fmt::format("--flight is {}, expected 0 to {}", options->flight,
                                   plan.campaign.records() - 1));
              if (!options->report.empty() && !options->report.ends_with(".html"))
                refuse("replay", "--report",
                       fmt::format("--report is '{}', expected a name that ends in .html",
                                   options->report));
              if (!options->log.empty() && !options->log.ends_with(".csv") &&
                  !options->log.ends_with(".mat"))
                refuse("replay", "--log",
                       fmt::format("--log is '{}', expected a name that ends in .csv or .mat",
                                   options->log));
              PlannedFlight flight = replayed_flight(plan, options->flight);
              if (!options->log.empty() || !options->report.empty())
                option_of_command("campaign replay", [&] { keep_log(flight); });
              const FlownFlight flown = fly_planned(std::move(flight), interrupted);
              if (!options->log.empty()) {
                write_file(options->log, log_bytes(flown.result.log, options->log));
                context.written.push_back(options->log);
              }
              if (!options->report.empty()) {
                write_file(options->report, html(report_of(flown, context.command)));
                context.written.push_back(options->report);
              }
              if (context.json)
                context.out << internal::readable(to_json(flown)) << "\n";
              else
                context.out << to_text(flown);
              if (!flown.passed) throw AnswerIsNo("campaign replay: " + reasons(flown).front());
            };
          }};
}

}  // namespace

std::vector<Verb> campaign_verbs() {
  return {init_verb(), work_verb(), status_verb(), merge_verb(), run_verb(), replay_verb()};
}

}  // namespace quadtune::cli
