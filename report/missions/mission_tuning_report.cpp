// SPDX-License-Identifier: Apache-2.0
#include "report/missions/mission_tuning_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <variant>

#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "report/flights/flights.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;
using Report = MissionTuningResult;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The heading of the column of the best point.
std::string found_word(const Report& report) {
  return report.search.accepted ? "found" : "not taken";
}

/// The measure over the draws: "mean", "0.9 quantile", "worst".
std::string measure_of(const Report& report) {
  const TrialRequest& request = report.request;
  return request.measure == RobustMeasure::quantile ? fmt::format("{:g} quantile", request.share)
                                                    : to_string(request.measure);
}

/// The outcomes are those on fresh draws if they were flown.
bool proved(const Report& report) { return !report.search.proof_before.costs.empty(); }
const TrialOutcome& outcome_before(const Report& report) {
  return proved(report) ? report.search.proof_before : report.search.before;
}
const TrialOutcome& outcome_after(const Report& report) {
  return proved(report) ? report.search.proof_after : report.search.after;
}

/// The outcomes of the columns: start, best point, and published gains if there are any.
std::vector<const TrialOutcome*> outcomes_of(const Report& report) {
  std::vector<const TrialOutcome*> outcomes = {&outcome_before(report), &outcome_after(report)};
  if (report.rival) outcomes.push_back(&*report.rival);
  return outcomes;
}

/// A metric of a mission, with its value in each of outcomes_of().
struct Figure {
  std::size_t mission = 0;
  Metric metric = Metric::duration;
  std::vector<double> values;
};

/// The metrics of the missions that have a value in some flight: the usual ones, then those of the
/// cost and of limits.
std::vector<Figure> figures_of(const Report& report) {
  const std::vector<const TrialOutcome*> outcomes = outcomes_of(report);
  std::vector<Figure> figures;
  for (std::size_t m = 0; m < report.request.missions.size(); ++m) {
    std::vector<Metric> told = {Metric::tracking_rms, Metric::tracking_max, Metric::settling_time,
                                Metric::overshoot,    Metric::tilt_max,     Metric::saturation_time,
                                Metric::energy};
    const auto tell = [&](Metric metric) {
      if (std::find(told.begin(), told.end(), metric) == told.end()) told.push_back(metric);
    };
    for (const CostTerm& term : report.request.cost)
      if (term.weight > 0) tell(term.metric);
    for (const Limit& limit : report.request.missions[m].limits) tell(limit.metric);
    for (const Metric metric : told) {
      Figure figure{m, metric, {}};
      for (const TrialOutcome* outcome : outcomes)
        figure.values.push_back(outcome->means[m][metric]);
      if (!std::isnan(figure.values[0]) || !std::isnan(figure.values[1]))
        figures.push_back(std::move(figure));
    }
  }
  return figures;
}

// --- text ---

std::string gains_text(const CascadeGains& before, const CascadeGains& after) {
  const auto pair = [](double then, double now) {
    return then == now ? fmt::format("{:.4g}", now) : fmt::format("{:.4g} -> {:.4g}", then, now);
  };
  Cells cells = {{"loop", "Kp", "Ki", "Kd"}};
  for (std::size_t i = 0; i < before.loops.size(); ++i) {
    const PidLoop& then = before.loops[i];
    const PidLoop& now = after.loops[i];
    cells.push_back(
        {now.name, pair(then.Kp, now.Kp), pair(then.Ki, now.Ki), pair(then.Kd, now.Kd)});
  }
  return aligned(cells);
}

std::string gains_text(const TunedWeights& before, const TunedWeights& after) {
  Cells cells = {{"weight", "start", "found"}};
  for (std::size_t i = 0; i < before.names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    cells.push_back(
        {before.names[i], figure(before.weights(k), ".5g"), figure(after.weights(k), ".5g")});
  }
  return aligned(cells);
}

std::string gains_text(const TunedGains& before, const TunedGains& after) {
  return std::visit(
      [&](const auto& then) {
        return gains_text(then, std::get<std::decay_t<decltype(then)>>(after));
      },
      before);
}

std::string missions_text(const Report& report) {
  Cells cells = {{"mission", "figure, mean", "start", found_word(report)}};
  if (report.rival) cells[0].emplace_back("published");
  cells[0].emplace_back("unit");
  const auto row = [&](const std::string& mission, const std::string& label, const auto& values,
                       const char* format, const std::string& unit) {
    cells.push_back({mission, label});
    for (const double value : values) cells.back().push_back(reached(value, format));
    cells.back().push_back(unit);
  };
  for (const Figure& figure : figures_of(report))
    row(report.request.missions[figure.mission].name, label_of(figure.metric), figure.values, ".4g",
        unit_text(unit_of(figure.metric)));
  std::vector<double> costs, failures;
  for (const TrialOutcome* outcome : outcomes_of(report)) {
    costs.push_back(outcome->cost);
    failures.push_back(static_cast<double>(outcome->failed));
  }
  const bool mean = report.request.measure == RobustMeasure::mean;
  row("all", mean ? "cost" : "cost, " + measure_of(report), costs, ".4g", "");
  row("all", "flights that end early", failures, ".0f",
      fmt::format("of {}", outcome_before(report).flights));
  return aligned(cells, report.rival ? "<<>>><" : "<<>><");
}

std::string loops_text(const std::vector<NamedMargins>& before,
                       const std::vector<NamedMargins>& after,
                       const std::vector<NamedMargins>* rival, const std::string& found) {
  const auto Ms = [](const std::vector<NamedMargins>& loops, std::size_t i) {
    return i < loops.size() ? figure(loops[i].margins.Ms, ".4g") : "-";
  };
  Cells cells = {{"loop", "Ms: start", found}};
  if (rival) cells[0].emplace_back("published");
  for (const char* heading : {"phase [deg]", "gain [dB]", "delay [ms]"})
    cells[0].emplace_back(heading);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const LoopMargins& m = after[i].margins;
    cells.push_back({after[i].name, Ms(before, i), Ms(after, i)});
    if (rival) cells.back().push_back(Ms(*rival, i));
    for (const double value :
         {degrees(m.phase_margin), decibels(m.gain_margin), 1000 * m.delay_margin})
      cells.back().push_back(figure(value, ".4g"));
  }
  return aligned(cells);
}

std::string margins_text(const Report& report) {
  return loops_text(report.before, report.after,
                    report.tuning.rival ? &report.tuning.rival->margins : nullptr,
                    found_word(report));
}

/// The margins by name; empty if the loop is unstable or missing.
std::vector<NamedMargins> named(const std::optional<FlownLoop>& loop) {
  std::vector<NamedMargins> all;
  if (!loop || loop->grows()) return all;
  for (std::size_t i = 0; i < loop->margins.loops.size(); ++i)
    all.push_back({loop->margins.names[i], loop->margins.loops[i]});
  return all;
}

std::string flown_text(const Report& report) {
  const FlownEvidence& flown = report.flown;
  if (!flown.after) return "the flown loop was not analysed: " + flown.why;
  std::string text;
  const auto unstable = [&](const std::optional<FlownLoop>& loop, const std::string& what) {
    if (loop && loop->grows()) text += fmt::format("{}: unstable, {}\n", what, describe(*loop));
  };
  unstable(flown.before, "start");
  unstable(flown.after, found_word(report));
  unstable(flown.rival, "published");
  const std::vector<NamedMargins> after = named(flown.after), rival = named(flown.rival);
  if (after.empty()) {
    text.pop_back();
    return text;
  }
  return text +
         loops_text(named(flown.before), after, flown.rival ? &rival : nullptr, found_word(report));
}

// --- JSON ---

Json gains_json(const TunedGains& gains) {
  if (const auto* cascade = std::get_if<CascadeGains>(&gains)) {
    Json loops = Json::array();
    for (const PidLoop& loop : cascade->loops)
      loops.push_back({{"name", loop.name}, {"Kp", loop.Kp}, {"Ki", loop.Ki}, {"Kd", loop.Kd}});
    return loops;
  }
  const auto& tuned = std::get<TunedWeights>(gains);
  Json json = {{"weights", Json::object()}};
  for (std::size_t i = 0; i < tuned.names.size(); ++i)
    json["weights"][tuned.names[i]] = tuned.weights(static_cast<Eigen::Index>(i));
  if (tuned.gains) {
    json["K"] = internal::matrix_to_json(tuned.gains->K, "K");
    json["K_int"] = internal::matrix_to_json(tuned.gains->K_int, "K_int");
  }
  return json;
}

Json margins_json(const std::vector<NamedMargins>& loops) {
  Json json = Json::array();
  for (const NamedMargins& loop : loops)
    json.push_back({{"loop", loop.name},
                    {"Ms", loop.margins.Ms},
                    {"phase_margin_deg", degrees(loop.margins.phase_margin)},
                    {"gain_margin_db", decibels(loop.margins.gain_margin)},
                    {"delay_margin_s", loop.margins.delay_margin}});
  return json;
}

/// The estimator and the stability of a flown loop, and its margins if it is stable.
Json flown_json(const std::optional<FlownLoop>& loop) {
  if (!loop) return nullptr;
  return {{"estimator", loop->estimator},
          {"stable", !loop->grows()},
          {"slowest_mode", describe(*loop)},
          {"margins", margins_json(named(loop))}};
}

Json outcome_json(const Report& report, const TrialOutcome& outcome) {
  Json missions = Json::array();
  for (std::size_t m = 0; m < outcome.means.size(); ++m) {
    Json metrics = Json::object();
    for (std::size_t i = 0; i < kMetrics; ++i)
      metrics[name_of(static_cast<Metric>(i))] = outcome.means[m].value[i];
    missions.push_back({{"mission", report.request.missions[m].name}, {"mean", metrics}});
  }
  Json limits = Json::array();
  for (const TrialLimit& limit : outcome.limits)
    limits.push_back({{"mission", limit.mission},
                      {"metric", name_of(limit.metric)},
                      {"value", limit.value},
                      {"at_most", limit.max},
                      {"ok", limit.excess() <= kLimitTolerance}});
  return {{"cost", outcome.cost},
          {"flights", outcome.flights},
          {"ended_early", outcome.failed},
          {"missions", missions},
          {"limits", limits}};
}

// --- the page ---

PageCompared row(std::string of, std::string label, std::string unit, std::vector<double> values) {
  PageCompared compared;
  compared.of = std::move(of);
  compared.label = std::move(label);
  compared.unit = std::move(unit);
  compared.values = std::move(values);
  return compared;
}

/// "Ms of yaw: 10 % looser would lower the cost by 1.3 %", for each active limit.
std::vector<std::string> binding_words(const MissionSearchResult& result) {
  std::vector<std::string> words = result.binding;
  for (std::size_t i = 0; i < result.buys.size(); ++i) {
    const double buys = result.buys[i];
    words[i] += fmt::format(": {:g} % looser would lower the cost by {}", 100 * kLoosened,
                            buys < 0.1 ? "less than 0.1 %" : fmt::format("{:.2g} %", buys));
  }
  return words;
}

bool binds(const Report& report, const std::string& limit) {
  const std::vector<std::string>& all = report.search.binding;
  return std::find(all.begin(), all.end(), limit) != all.end();
}

PageComparedTable missions_table(const Report& report) {
  PageComparedTable table;
  table.id = "missions";
  table.title = "Missions";
  const TrialOutcome &before = outcome_before(report), &after = outcome_after(report);
  const std::string draws =
      fmt::format("{} {} draws", before.costs.size(), proved(report) ? "fresh" : "search");
  table.hint = fmt::format("Means over {}, the same for each column; a limit applies to the {}.",
                           draws, measure_of(report));
  if (before.failed + after.failed + (report.rival ? report.rival->failed : 0) > 0)
    table.hint +=
        " A flight that ends early violates all limits; its metrics are those up to its end.";
  const auto values = [&](const auto& of) {
    std::vector<double> all;
    for (const TrialOutcome* outcome : outcomes_of(report)) all.push_back(of(*outcome));
    return all;
  };
  PageCompared cost = row("All", "cost, " + measure_of(report) + " of the draws", "",
                          values([](const TrialOutcome& outcome) { return outcome.cost; }));
  cost.main = true;
  table.rows.push_back(std::move(cost));
  PageCompared early =
      row("All", "flights that end early", fmt::format("of {}", before.flights),
          values([](const TrialOutcome& o) { return static_cast<double>(o.failed); }));
  table.rows.push_back(std::move(early));
  for (const Figure& figure : figures_of(report)) {
    const TrialMission& mission = report.request.missions[figure.mission];
    PageCompared compared = row(mission.name, label_of(figure.metric),
                                unit_text(unit_of(figure.metric)), figure.values);
    const auto limit = std::find_if(mission.limits.begin(), mission.limits.end(),
                                    [&](const Limit& l) { return l.metric == figure.metric; });
    if (limit != mission.limits.end()) {
      // Two missions may have the same name, e.g. in calm and in wind, so limits are counted
      // mission by mission.
      auto at = static_cast<std::size_t>(limit - mission.limits.begin());
      for (std::size_t m = 0; m < figure.mission; ++m)
        at += report.request.missions[m].limits.size();
      compared.limit = limit->max;
      for (const TrialOutcome* outcome : outcomes_of(report))
        compared.broken.push_back(outcome->limits[at].excess() > kLimitTolerance);
      compared.binds = binds(report, fmt::format("{} of {}", name_of(figure.metric), mission.name));
    }
    table.rows.push_back(std::move(compared));
  }
  return table;
}

/// A margin and its format on the page.
struct MarginKind {
  const char* name;
  const char* label;
  const char* unit;
  double (*value)(const LoopMargins&);
  double (*shown)(double);
};
constexpr MarginKind kMarginKinds[] = {
    {"Ms", "Ms", "", [](const LoopMargins& m) { return m.Ms; }, [](double x) { return x; }},
    {"phase margin", "phase", "deg", [](const LoopMargins& m) { return m.phase_margin; },
     [](double x) { return degrees(x); }},
    {"gain margin", "gain", "dB", [](const LoopMargins& m) { return m.gain_margin; },
     [](double x) { return decibels(x); }},
    {"delay margin", "delay", "ms", [](const LoopMargins& m) { return m.delay_margin; },
     [](double x) { return 1000 * x; }}};

PageComparedTable flown_table(const Report& report) {
  PageComparedTable table;
  table.id = "flown";
  table.title = "Margins of the flown loop";
  table.hint = fmt::format(
      "Motor lag, delays, sensors and estimator included ({}); cut at the outputs of the law.",
      report.flown.after->estimator);
  std::vector<std::vector<NamedMargins>> columns = {named(report.flown.before),
                                                    named(report.flown.after)};
  if (report.tuning.rival) columns.push_back(named(report.flown.rival));
  const std::vector<std::string>& names = report.flown.after->margins.names;
  for (std::size_t i = 0; i < names.size(); ++i)
    for (const MarginKind& kind : kMarginKinds) {
      std::vector<double> values;
      values.reserve(columns.size());
      for (const std::vector<NamedMargins>& column : columns)
        values.push_back(i < column.size() ? kind.shown(kind.value(column[i].margins)) : kNaN);
      table.rows.push_back(row(names[i], kind.label, kind.unit, std::move(values)));
    }
  return table;
}

PageComparedTable margins_table(const Report& report) {
  PageComparedTable table;
  table.id = "margins";
  table.title = "Margins of the loops";
  table.hint = "For the vehicle of the file, with true states.";
  for (std::size_t i = 0; i < report.after.size(); ++i)
    for (const MarginKind& kind : kMarginKinds) {
      std::vector<double> plain;
      for (const std::vector<NamedMargins>* of :
           {&report.before, &report.after,
            report.tuning.rival ? &report.tuning.rival->margins : nullptr})
        if (of != nullptr && i < of->size())
          plain.push_back((*of)[i].margins.stable ? kind.value((*of)[i].margins) : kNaN);
      std::vector<double> values;
      values.reserve(plain.size());
      for (const double x : plain) values.push_back(kind.shown(x));
      PageCompared compared = row(report.after[i].name, kind.label, kind.unit, values);
      const std::string name = fmt::format("{} of {}", kind.name, report.after[i].name);
      // Of two limits, one for all loops and one for this loop, the stricter applies.
      const DesignLimit* limit = nullptr;
      for (const DesignLimit& one : report.limits)
        if (one.name == name && (limit == nullptr || (one.at_least ? one.bound > limit->bound
                                                                   : one.bound < limit->bound)))
          limit = &one;
      if (limit != nullptr) {
        compared.limit = kind.shown(limit->bound);
        compared.at_least = limit->at_least;
        for (const double x : plain) {
          DesignLimit held = *limit;
          held.value = x;
          compared.broken.push_back(held.excess() > kLimitTolerance);
        }
        compared.binds = binds(report, name);
      }
      table.rows.push_back(std::move(compared));
    }
  return table;
}

PageComparedTable gains_table(const Report& report) {
  PageComparedTable table;
  table.id = "gains";
  table.title = report.tuning.gains_title;
  const std::vector<TunedNumber> before = report.tuning.numbers(report.tuning.start),
                                 after = report.tuning.numbers(report.search.candidate);
  for (std::size_t i = 0; i < after.size(); ++i) {
    std::vector<double> values = {before[i].value, after[i].value};
    if (report.tuning.rival) {
      const std::vector<TunedNumber>& all = report.tuning.rival->numbers;
      const auto same = std::find_if(all.begin(), all.end(), [&](const TunedNumber& number) {
        return number.of == after[i].of && number.name == after[i].name;
      });
      values.push_back(same == all.end() ? kNaN : same->value);
    }
    table.rows.push_back(row(after[i].of, after[i].name, after[i].unit, std::move(values)));
  }
  return table;
}

PageSearch search_of(const MissionSearchResult& result) {
  constexpr std::size_t kMaxPoints = 2000;
  PageSearch search;
  const std::vector<SearchStep>& steps = result.steps;
  const std::size_t stride = steps.size() / kMaxPoints + 1;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool improved = i == 0 || i + 1 == steps.size() || steps[i].best != steps[i - 1].best;
    if (!improved && i % stride != 0) continue;
    search.evaluation.push_back(static_cast<double>(i + 1));
    search.best.push_back(steps[i].best);
    search.tried.push_back(steps[i].allowed ? steps[i].cost : kNaN);
  }
  return search;
}

/// The distance of each controller from the reference, for each mission.
std::vector<PageFlown> flown(const std::vector<TunedFlights>& missions,
                             const std::vector<std::string>& names) {
  constexpr double kMin = 1e-4;  // [m]; the axis is logarithmic
  std::vector<PageFlown> all;
  for (const TunedFlights& mission : missions) {
    const DistanceOverTime& longest = *std::max_element(
        mission.distances.begin(), mission.distances.end(), [](const auto& a, const auto& b) {
          return a.time.empty() || (!b.time.empty() && a.time.back() < b.time.back());
        });
    PageFlown& page = all.emplace_back();
    page.plot = {"Distance from the reference, " + mission.mission, "m", {}, 1, true};
    page.log.columns.push_back({"t", "s", longest.time});
    for (std::size_t c = 0; c < mission.distances.size(); ++c) {
      LogColumn column{fmt::format("c{}", c), "m", {}};
      for (const double t : longest.time) {
        const double distance = mission.distances[c].at(t);
        column.values.push_back(std::isnan(distance) ? distance : std::max(distance, kMin));
      }
      page.plot.series.push_back({names[c], column.name});
      page.log.columns.push_back(std::move(column));
    }
  }
  return all;
}

}  // namespace

std::string to_text(const Report& report) {
  const MissionSearchResult& r = report.search;
  std::string gains =
      gains_text(report.tuning.gains(report.tuning.start), report.tuning.gains(r.candidate));
  if (!r.accepted && r.candidate != report.tuning.start)
    gains = "start and rejected result\n" + gains;
  std::string text = section("gains", gains);
  text += section("missions", missions_text(report));
  if (!report.widened.empty()) {
    std::vector<std::string> lines;
    for (const TunedLimit& one : report.widened)
      lines.push_back(fmt::format("{}: {}, {}", one.mission, one.limit.label, describe(one.limit)));
    text += section("widened", fmt::format("{}", internal::joined(lines, "\n")));
  }
  text += section("margins", margins_text(report));
  text += section("flown", flown_text(report));
  if (!r.binding.empty())
    text += section("binding", fmt::format("{}", internal::joined(binding_words(r), "\n")));
  if (!r.broken.empty())
    text += section("violated", fmt::format("{}", internal::joined(r.broken, "\n")));
  return text +
         section("verdict",
                 fmt::format(
                     "{}: {}\n{}{} in {:.3g} s, end: {}",
                     r.accepted ? "better" : "the start is kept", r.reason,
                     r.broken.empty() ? ""
                                      : fmt::format("violates {} of the limits\n", r.broken.size()),
                     internal::counted(r.evaluations, "evaluation"), r.seconds, to_string(r.end)));
}

Json loosened_json(const MissionSearchResult& result) {
  Json all = Json::array();
  for (std::size_t i = 0; i < result.buys.size(); ++i)
    all.push_back({{"limit", result.binding[i]},
                   {"looser_percent", 100 * kLoosened},
                   {"cost_less_percent", result.buys[i]}});
  return all;
}

Json to_json(const Report& report) {
  const MissionSearchResult& r = report.search;
  Json json = {
      {"accepted", r.accepted},
      {"reason", r.reason},
      {"gains", gains_json(report.tuning.gains(r.best))},
      {"cost", {{"before", r.before.cost}, {"after", r.after.cost}}},
      {"before", outcome_json(report, outcome_before(report))},
      {"after", outcome_json(report, outcome_after(report))},
      {"difference",
       {{"value", r.difference.value}, {"low", r.difference.low}, {"high", r.difference.high}}},
      {"margins", {{"before", margins_json(report.before)}, {"after", margins_json(report.after)}}},
      {"flown",
       {{"before", flown_json(report.flown.before)}, {"after", flown_json(report.flown.after)}}},
      {"binding", r.binding},
      {"loosened", loosened_json(r)},
      {"broken", r.broken},
      {"evaluations", r.evaluations},
      {"seconds", r.seconds},
      {"end", to_string(r.end)}};
  if (!r.accepted && r.candidate != report.tuning.start)
    json["not_taken"] = gains_json(report.tuning.gains(r.candidate));
  if (report.rival) {
    json["published"] = outcome_json(report, *report.rival);
    json["margins"]["published"] = margins_json(report.tuning.rival->margins);
    json["flown"]["published"] = flown_json(report.flown.rival);
  }
  json["widened"] = Json::array();
  for (const TunedLimit& one : report.widened)
    json["widened"].push_back({{"mission", one.mission},
                               {"what", one.limit.what},
                               {"unit", one.limit.unit},
                               {"asked", one.limit.asked},
                               {"sensors_rms", one.limit.bound},
                               {"judged_by", one.limit.judged}});
  if (!report.flown.why.empty()) json["flown"]["why"] = report.flown.why;
  return json;
}

GainsPage page_of(const Report& report, const std::vector<TunedFlights>& flights) {
  const MissionSearchResult& r = report.search;
  GainsPage page;
  std::vector<std::string> missions;
  for (const TrialMission& mission : report.request.missions) missions.push_back(mission.name);
  page.title =
      fmt::format("{} over {}", report.tuning.vehicle.name, internal::joined(missions, ", "));
  page.verdict = r.accepted ? ReportVerdict::pass : ReportVerdict::fail;
  page.counts = fmt::format("Cost {:.4g} \u2192 {:.4g}", outcome_before(report).cost,
                            outcome_after(report).cost);
  if (proved(report) && r.candidate != report.tuning.start)
    page.counts +=
        fmt::format("; {} of {} fresh draws {:.3g} % {}, 95 % interval {:.3g} to {:.3g} %",
                    report.request.measure == RobustMeasure::quantile ? measure_of(report) : "mean",
                    r.proof_before.costs.size(), std::abs(r.less), r.less < 0 ? "more" : "less",
                    r.less < 0 ? -r.less_high : r.less_low, r.less < 0 ? -r.less_low : r.less_high);
  if (!r.accepted) page.reasons.push_back("The start is kept: " + r.reason + ".");
  if (r.repaired) page.reasons.push_back("It meets all limits; the start does not.");
  if (!r.binding.empty())
    page.reasons.push_back(
        fmt::format("Binding limits: {}.", internal::joined(binding_words(r), "; ")));
  if (!r.broken.empty())
    page.reasons.push_back(
        fmt::format("Violated nevertheless: {}.", internal::joined(r.broken, ", ")));
  page.columns = {"start", found_word(report)};
  if (report.tuning.rival) page.columns.push_back(report.tuning.rival->name);
  page.tables = {missions_table(report), margins_table(report)};
  if (report.flown.after) page.tables.push_back(flown_table(report));
  page.tables.push_back(gains_table(report));
  page.search = search_of(r);
  page.flown = flown(flights, page.columns);
  std::vector<std::string> cost;
  for (const CostTerm& term : report.request.cost)
    if (term.weight > 0)
      cost.push_back(fmt::format("{:g} \u00d7 {}", term.weight, label_of(term.metric)));
  page.about = {
      {"start", report.tuning.law},
      {"cost", fmt::format("{}; each relative to that of the start, mission by mission",
                           internal::joined(cost, " + "))},
      {"measure", fmt::format("{} of {} draws", measure_of(report), report.request.draws)},
      {"search",
       fmt::format("{} in {:.3g} s, end: {}", internal::counted(r.evaluations, "evaluation"),
                   r.seconds, to_string(r.end))},
      {"searched", fmt::format("{}", internal::joined(report.tuning.names, "; "))}};
  std::vector<std::string> varied;
  for (const auto& number : report.request.uncertainty.numbers) varied.push_back(number.quantity);
  page.about.emplace_back(
      "drawn", varied.empty() ? "noise and wind"
                              : fmt::format("{}; noise and wind", internal::joined(varied, ", ")));
  return page;
}

}  // namespace quadtune::report
