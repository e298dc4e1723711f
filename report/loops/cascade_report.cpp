// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/cascade_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/plots/figure.hpp"
#include "report/plots/loop_figure.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

const PidLoop& written(const CascadeReport& report, CascadeAxis axis) {
  return report.cascade.gains.loops[index_of(axis)];
}

Json evidence_json(const CascadeLoopEvidence& evidence) {
  const LoopMargins& m = evidence.margins;
  if (!m.stable) return {{"stable", false}};  // the metrics of an unstable loop are meaningless
  return {{"stable", m.stable},
          {"rate_crossover", evidence.rate.crossover},
          {"bandwidth", evidence.bandwidth},
          {"crossover", m.crossover},
          {"phase_margin_deg", degrees(m.phase_margin)},
          {"gain_margin_db", decibels(m.gain_margin)},
          {"delay_margin_s", m.delay_margin},
          {"Ms", m.Ms},
          {"Mt", m.Mt},
          {"tracking_peak", evidence.tracking_peak},
          {"load_integral", evidence.load_integral},
          {"load_peak", evidence.load_peak},
          {"load_left", evidence.load_steady_state},
          {"value_noise", evidence.value_noise},
          {"rate_noise", evidence.rate_noise}};
}

/// The loop as published in the vehicle file.
const PidLoop& as_published(const CascadeReport& report, CascadeAxis axis) {
  const std::vector<PidLoop>& loops = report.published->loops;
  return *std::find_if(loops.begin(), loops.end(),
                       [&](const PidLoop& loop) { return loop.name == to_string(axis); });
}

Json gains_json(const PidLoop& loop) {
  Json json = {{"name", loop.name}, {"output", loop.output}, {"unit", loop.unit},
               {"Kp", loop.Kp},     {"Ki", loop.Ki},         {"Kd", loop.Kd}};
  if (loop.rate_lead != 0) {
    json["rate_lead_s"] = loop.rate_lead;
    json["rate_filter_s"] = loop.rate_filter;
  }
  return json;
}

Json loops_json(const CascadeReport& report) {
  Json loops = Json::array();
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    Json row = gains_json(written(report, loop.axis));
    row.update(evidence_json(loop.design.evidence));
    row["binding"] = loop.design.binding;
    row["highest_rate_crossover"] = loop.design.highest_rate_crossover;
    row["published"] = nullptr;
    if (loop.published) {
      row["published"] = gains_json(as_published(report, loop.axis));
      row["published"].update(evidence_json(loop.published_evidence));
    }
    loops.push_back(std::move(row));
  }
  return loops;
}

std::string loops_text(const CascadeReport& report) {
  Json rows = loops_json(report);
  for (Json& row : rows) {
    const std::string& output = row["output"].text();
    row["output"] = output.substr(0, output.find(','));
  }
  std::vector<Column> columns = {{"name", "loop"},
                                 {"Kp", "Kp", "", ".4g"},
                                 {"Ki", "Ki", "", ".4g"},
                                 {"Kd", "Kd", "", ".4g"},
                                 {"output", "to"},
                                 {"rate_crossover", "rate", "[rad/s]", ".3g"},
                                 {"bandwidth", "value", "[rad/s]", ".3g"},
                                 {"gain_margin_db", "gain", "[dB]", ".1f"},
                                 {"phase_margin_deg", "phase", "[deg]", ".1f"},
                                 {"delay_margin_s", "delay", "[ms]", ".1f", 1e3},
                                 {"Ms", "Ms", "", ".3f"},
                                 {"tracking_peak", "set point", "peak", ".2f"},
                                 {.key = "stable", .no = "UNSTABLE"}};
  const std::vector<PidLoop>& loops = report.cascade.gains.loops;
  if (std::any_of(loops.begin(), loops.end(),
                  [](const PidLoop& loop) { return loop.rate_lead != 0; }))
    columns.insert(columns.begin() + 4, {"rate_lead_s", "lead", "[ms]", ".1f", 1e3});
  return table(rows, columns);
}

std::string bound_text(const CascadeReport& report) {
  std::string text;
  for (const CascadeAxisDesign& loop : report.cascade.loops)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", to_string(loop.axis),
                        loop.design.binding.empty()
                            ? "nothing"
                            : fmt::format("{}", internal::joined(loop.design.binding, ", ")));
  return text;
}

/// "1.067 (1.075)"
std::string pair(double here, double there, const char* format) {
  return fmt::format("{} ({})", figure(here, format), figure(there, format));
}

std::string comparison_text(const CascadeReport& report) {
  Cells cells = {{"loop", "Ms", "Ki", "load: peak", "left", "noise: value", "rate"}};
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    if (!loop.published) continue;
    const CascadeLoopEvidence& here = loop.design.evidence;
    const CascadeLoopEvidence& there = loop.published_evidence;
    cells.push_back({to_string(loop.axis), pair(here.margins.Ms, there.margins.Ms, ".3f"),
                     pair(std::abs(loop.design.gains.Ki), std::abs(loop.published->Ki), ".3g"),
                     pair(here.load_peak, there.load_peak, ".4g"),
                     pair(here.load_steady_state, there.load_steady_state, ".3g"),
                     pair(here.value_noise, there.value_noise, ".3g"),
                     pair(here.rate_noise, there.rate_noise, ".3g"),
                     there.margins.stable ? "" : "published: UNSTABLE"});
  }
  return fmt::format(
             "in parentheses the published gains, {}; a load step added to the command, and sensor "
             "noise in the command\n",
             report.published_source) +
         aligned(cells);
}

/// A metric of a loop, here and as published; smaller is better.
struct ComparedFigure {
  const char* name;
  double here;
  double there;

  /// Improvement in per cent. A difference below 1e-6 is within the tolerance of the search.
  [[nodiscard]] double gain() const { return here == there ? 0 : 100 * (1 - here / there); }
  [[nodiscard]] bool worse() const { return here > there * (1 + 1e-6); }
  [[nodiscard]] std::string text() const {
    if (here == there || std::abs(gain()) < 0.05) return "same";
    if (std::isinf(here) || there == 0) return "worse";
    if (std::isinf(there)) return "all";
    return fmt::format("{:.1f} %", gain());
  }
};

std::vector<ComparedFigure> figures(const CascadeAxisDesign& loop) {
  const CascadeLoopEvidence& here = loop.design.evidence;
  const CascadeLoopEvidence& there = loop.published_evidence;
  return {{"Ms - 1", here.margins.Ms - 1, there.margins.Ms - 1},
          {"load: integral", here.load_integral, there.load_integral},
          {"load: peak", here.load_peak, there.load_peak},
          {"noise: value", here.value_noise, there.value_noise},
          {"noise: rate", here.rate_noise, there.rate_noise}};
}

/// The improvement of each metric over the published cascade, and the regressions.
std::string verdict(const CascadeReport& report) {
  Cells cells = {{"loop"}};
  for (const ComparedFigure& figure : figures(report.cascade.loops.front()))
    cells[0].push_back(figure.name);
  std::vector<std::string> losses;
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    if (!loop.published) continue;
    const bool measured = loop.published_evidence.margins.stable;
    cells.push_back({to_string(loop.axis)});
    for (const ComparedFigure& figure : figures(loop)) {
      cells.back().push_back(measured ? figure.text() : "-");
      if (measured && figure.worse())
        losses.push_back(fmt::format("{} ({})", to_string(loop.axis), figure.name));
    }
    if (!measured) cells.back().push_back("the published loop is unstable");
  }
  return aligned(cells) +
         (losses.empty() ? "\nno regressions" : "\nregressions: " + internal::joined(losses, ", "));
}

}  // namespace

Json to_json(const CascadeReport& report) {
  const CascadeSpecification& s = report.specification;
  Json delays = Json::object();
  for (const CascadeAxis axis : kAllCascadeAxes) delays[to_string(axis)] = s.delay[index_of(axis)];
  Json json = {{"vehicle", report.vehicle},
               {"dt", s.dt},
               {"sensor_delay_s", delays},
               {"integrator", to_string(report.specification.method)},
               {"structure", to_string(report.specification.structure)},
               {"motor_lag_s", *report.specification.lag},
               {"published",
                report.published_source.empty() ? Json(nullptr) : Json(report.published_source)}};
  json["loops"] = loops_json(report);
  json["margins"] = to_json(report.margins);
  json["spectral_radius"] = report.cascade.poles.cwiseAbs().maxCoeff();
  return json;
}

std::string to_text(const CascadeReport& report) {
  const CascadeSpecification& s = report.specification;
  std::string text =
      section("cascade",
              fmt::format("{} at hover, every {} s, motor lag {} s, integrals by {}",
                          report.vehicle, number(s.dt), number(*s.lag), to_string(s.method))) +
      section("loops", loops_text(report));
  if (report.designed) text += section("bound by", bound_text(report));
  if (!report.published_source.empty())
    text +=
        section("comparison", comparison_text(report)) + section("improvement", verdict(report));
  const double radius = report.cascade.poles.cwiseAbs().maxCoeff();
  text +=
      section("margins", to_text(report.margins)) +
      section("closed", fmt::format("{}: {} poles of all loops together, largest modulus {:.6f}",
                                    unstable(report) ? "UNSTABLE" : "stable",
                                    report.cascade.poles.size(), radius));
  return text;
}

using internal::Json;

Json to_json(const VehicleCascade& cascade) {
  Json json = to_json(cascade.report);
  json["method"] = cascade.flown ? "flown" : "loops";
  json["plant"] = cascade.ideal ? "ideal" : cascade.flown ? "flown" : "lag";
  if (cascade.flown) json["flown"] = family_json(*cascade.flown);
  json["flown_loop"] = Json();
  if (cascade.loop) {
    json["flown_loop"] = to_json(*cascade.loop);
    json["flown_loop"]["margins"] = to_json(cascade.loop->margins);
  }
  add_laws(json, cascade.content);
  return json;
}

std::string to_text(const VehicleCascade& cascade) {
  std::string text = to_text(cascade.report);
  if (cascade.flown) text += section("flown", family_text(*cascade.flown));
  if (cascade.loop)
    text += section("flown loop", to_text(*cascade.loop)) +
            section("margins of the flown loop", to_text(cascade.loop->margins));
  return text;
}

Figure cascade_figure(const VehicleCascade& cascade) {
  const CascadeReport& report = cascade.report;
  return margins_figure(fmt::format("PID cascade of {} every {} s, cut at the wrench",
                                    report.vehicle, number(report.specification.dt)),
                        OpenLoop(report.open_loop), report.margins);
}

}  // namespace quadtune::report
