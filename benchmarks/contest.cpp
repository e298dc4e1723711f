// SPDX-License-Identifier: Apache-2.0
#include "contest.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "machine.hpp"

namespace quadtune::bench {
namespace {

/// Repetitions of one contestant [s of processor time per solve]; processor time is affected least
/// by other load on the machine.
struct Timing {
  std::vector<double> seconds;

  [[nodiscard]] double median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? std::nan("") : sorted[sorted.size() / 2];
  }
  [[nodiscard]] double fastest() const {
    return seconds.empty() ? std::nan("") : *std::min_element(seconds.begin(), seconds.end());
  }
};

/// Only collects the results, since the runs are interleaved and their order is not suitable for
/// output.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration && !run.error_occurred)
        timings[run.run_name.function_name].seconds.push_back(run.cpu_accumulated_time /
                                                              static_cast<double>(run.iterations));
  }

  std::map<std::string, Timing> timings;
};

std::string key(const Contest& contest, const Contestant& contestant) {
  return contest.name + " / " + contestant.name;
}

/// The entry of one contestant in the table.
struct Score {
  const Contestant* contestant;
  bool solved;
  double residual;
  double median;
  double fastest;
};

std::string microseconds(double seconds) { return fmt::format("{:.2f}", seconds * 1e6); }

std::vector<Score> scores(const Contest& contest, const std::map<std::string, Timing>& timings) {
  std::vector<Score> result;
  for (const Contestant& contestant : contest.contestants) {
    const auto found = timings.find(key(contest, contestant));
    if (found == timings.end()) continue;  // not selected by --benchmark_filter
    const bool solved = contestant.run();
    result.push_back({&contestant, solved, solved ? contestant.residual() : std::nan(""),
                      found->second.median(), found->second.fastest()});
  }
  return result;
}

void print_details(const Contest& contest, const std::vector<Score>& all) {
  for (const Score& score : all)
    fmt::print("{:<34} {:<22} {:>12} {:>12}   {}\n", contest.name, score.contestant->name,
               microseconds(score.median), microseconds(score.fastest),
               score.solved ? fmt::format("{:.1e}", score.residual) : "failed");
}

const Score* fastest_peer(const std::vector<Score>& all, const std::string& rival) {
  const Score* best = nullptr;
  for (const Score& score : all)
    if (!score.contestant->ours && score.solved &&
        score.contestant->name.find(rival) != std::string::npos &&
        (!best || score.median < best->median))
      best = &score;
  return best;
}

std::string verdict(const Contest& contest, const Score& ours, const std::vector<Score>& all,
                    double ratio) {
  if (!ours.solved) return "missed: not solved";
  if (contest.goal_ratio == 0) return "no goal";
  double best_residual = std::numeric_limits<double>::infinity();
  for (const Score& score : all)
    if (!score.contestant->ours && score.solved)
      best_residual = std::min(best_residual, score.residual);
  const double allowed = std::min(contest.goal_residual, std::max(10 * best_residual, 1e-15));
  if (!(ours.residual <= allowed)) return "missed: residual";
  return ratio >= contest.goal_ratio ? "met" : "missed: time";
}

void print_row(const Contest& contest, const std::vector<Score>& all) {
  const auto ours = std::find_if(all.begin(), all.end(),
                                 [](const Score& score) { return score.contestant->ours; });
  const Score* peer = fastest_peer(all, contest.rival);
  if (ours == all.end() || !peer) return;
  const double ratio = peer->median / ours->median;
  fmt::print("| {} | {} | {} ({}) | {:.1f} | {:.1e} | {:.1e} | {} | {} |\n", contest.name,
             microseconds(ours->median), microseconds(peer->median), peer->contestant->name, ratio,
             ours->residual, peer->residual,
             contest.goal_ratio == 0 ? "-" : fmt::format("{:g}", contest.goal_ratio),
             verdict(contest, *ours, all, ratio));
}

void register_contest([[maybe_unused]] const Contest& contest) {
#ifndef __clang_analyzer__  // which reports the registry of Google Benchmark as a leak
  for (const Contestant& contestant : contest.contestants)
    benchmark::RegisterBenchmark(key(contest, contestant).c_str(),
                                 [run = contestant.run](benchmark::State& state) {
                                   for (auto _ : state) benchmark::DoNotOptimize(run());
                                 });
#endif
}

// Defaults first, so that an option on the command line overrides them.
void initialize(int argc, char** argv) {
  std::vector<std::string> words = {argv[0], "--benchmark_enable_random_interleaving=true",
                                    "--benchmark_repetitions=15", "--benchmark_min_time=0.02"};
  words.insert(words.end(), argv + 1, argv + argc);
  static std::vector<std::string> kept;  // Google Benchmark keeps pointers into its arguments
  kept = words;
  std::vector<char*> pointers;
  pointers.reserve(kept.size());
  for (std::string& word : kept) pointers.push_back(word.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) std::exit(2);
}

}  // namespace

int run(const std::vector<Contest>& contests, int argc, char** argv) {
  initialize(argc, argv);
  use_one_thread();
  fmt::print("{}threads:  1\n\n", describe_machine());
  for (const Contest& contest : contests) register_contest(contest);
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);

  std::vector<std::vector<Score>> all;
  all.reserve(contests.size());
  for (const Contest& contest : contests) all.push_back(scores(contest, collector.timings));
  fmt::print("{:<34} {:<22} {:>12} {:>12}   {}\n", "problem", "solver", "median [us]", "least [us]",
             "residual");
  for (std::size_t i = 0; i < contests.size(); ++i) print_details(contests[i], all[i]);
  fmt::print(
      "\n| problem | quadtune [us] | fastest peer [us] | times faster | our residual | its "
      "residual "
      "| goal | verdict |\n|---|---:|---:|---:|---:|---:|---:|---|\n");
  for (std::size_t i = 0; i < contests.size(); ++i) print_row(contests[i], all[i]);
  return 0;
}

}  // namespace quadtune::bench
