// SPDX-License-Identifier: Apache-2.0
#include "report/loops/cascade_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::finite_or_null;
using internal::Json;

const PidLoop& written(const CascadeReport& report, CascadeAxis axis) {
  return report.cascade.gains.loops[index_of(axis)];
}

Json evidence_json(const CascadeLoopEvidence& evidence) {
  const LoopMargins& m = evidence.margins;
  if (!m.stable) return {{"stable", false}};  // sizes of what grows say nothing
  return {{"stable", m.stable},
          {"rate_crossover", evidence.rate.crossover},
          {"bandwidth", evidence.bandwidth},
          {"crossover", m.crossover},
          {"phase_margin_deg", finite_or_null(degrees(m.phase_margin))},
          {"gain_margin_db", finite_or_null(decibels(m.gain_margin))},
          {"delay_margin_s", finite_or_null(m.delay_margin)},
          {"Ms", finite_or_null(m.Ms)},
          {"Mt", finite_or_null(m.Mt)},
          {"tracking_peak", finite_or_null(evidence.tracking_peak)},
          {"load_integral", finite_or_null(evidence.load_integral)},
          {"load_peak", finite_or_null(evidence.load_peak)},
          {"load_left", finite_or_null(evidence.load_left)},
          {"value_noise", finite_or_null(evidence.value_noise)},
          {"rate_noise", finite_or_null(evidence.rate_noise)}};
}

/// As the vehicle's file has it.
const PidLoop& as_published(const CascadeReport& report, CascadeAxis axis) {
  const std::vector<PidLoop>& loops = report.published->loops;
  return *std::find_if(loops.begin(), loops.end(),
                       [&](const PidLoop& loop) { return loop.name == to_string(axis); });
}

Json gains_json(const PidLoop& loop) {
  return {{"name", loop.name}, {"output", loop.output}, {"unit", loop.unit},
          {"Kp", loop.Kp},     {"Ki", loop.Ki},         {"Kd", loop.Kd}};
}

std::string loop_row(const CascadeReport& report, const CascadeAxisDesign& loop) {
  const PidLoop& gains = written(report, loop.axis);
  const CascadeLoopEvidence& e = loop.design.evidence;
  const LoopMargins& m = e.margins;
  const auto cell = [](double value, const char* form) {
    return std::isfinite(value) ? fmt::format(fmt::runtime(form), value) : std::string("-");
  };
  return fmt::format(
      "{:<9}{:>11.4g}{:>11.4g}{:>11.4g}  {:<15}{:>9.3g}{:>9.3g}{:>7}{:>7}{:>8}{:>7}{:>10}{}\n",
      gains.name, gains.Kp, gains.Ki, gains.Kd,
      gains.output.substr(0, gains.output.find(" beside")), e.rate.crossover, e.bandwidth,
      cell(decibels(m.gain_margin), "{:.1f}"), cell(degrees(m.phase_margin), "{:.1f}"),
      cell(1e3 * m.delay_margin, "{:.1f}"), cell(m.Ms, "{:.3f}"), cell(e.tracking_peak, "{:.2f}"),
      m.stable ? "" : "  UNSTABLE");
}

std::string loops_text(const CascadeReport& report) {
  std::string text =
      fmt::format("{:<9}{:>11}{:>11}{:>11}  {:<15}{:>9}{:>9}{:>7}{:>7}{:>8}{:>7}{:>10}\n", "", "",
                  "", "", "", "rate", "value", "gain", "phase", "delay", "", "set point");
  text += fmt::format("{:<9}{:>11}{:>11}{:>11}  {:<15}{:>9}{:>9}{:>7}{:>7}{:>8}{:>7}{:>10}\n",
                      "loop", "Kp", "Ki", "Kd", "to", "[rad/s]", "[rad/s]", "[dB]", "[deg]", "[ms]",
                      "Ms", "peak");
  for (const CascadeAxisDesign& loop : report.cascade.loops) text += loop_row(report, loop);
  text.pop_back();
  return text;
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
std::string pair(double here, double there, const char* form) {
  const auto one = [&](double value) {
    return std::isfinite(value) ? fmt::format(fmt::runtime(form), value) : std::string("-");
  };
  return fmt::format("{} ({})", one(here), one(there));
}

std::string comparison_text(const CascadeReport& report) {
  std::string text =
      report.published_source +
      ", here (there): a step of load beside the loop's command, noise of the sensors in it\n" +
      fmt::format("{:<9}{:>14}{:>17}{:>16}{:>12}{:>20}{:>20}\n", "loop", "Ms", "Ki", "load: peak",
                  "left", "noise: value", "rate");
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    if (!loop.published) continue;
    const CascadeLoopEvidence& here = loop.design.evidence;
    const CascadeLoopEvidence& there = loop.published_evidence;
    text +=
        fmt::format("{:<9}{:>14}{:>17}{:>16}{:>12}{:>20}{:>20}\n", to_string(loop.axis),
                    pair(here.margins.Ms, there.margins.Ms, "{:.3f}"),
                    pair(std::abs(loop.design.gains.Ki), std::abs(loop.published->Ki), "{:.3g}"),
                    pair(here.load_peak, there.load_peak, "{:.4g}"),
                    pair(here.load_left, there.load_left, "{:.3g}"),
                    pair(here.value_noise, there.value_noise, "{:.3g}"),
                    pair(here.rate_noise, there.rate_noise, "{:.3g}"));
    if (!there.margins.stable) text.insert(text.size() - 1, "  there UNSTABLE");
  }
  text.pop_back();
  return text;
}

/// One figure of a loop, smaller the better, here and as published.
struct Figure {
  const char* name;
  double here;
  double there;

  /// In per cent; a part of a millionth is what the search leaves of a bound.
  [[nodiscard]] double gain() const { return here == there ? 0 : 100 * (1 - here / there); }
  [[nodiscard]] bool worse() const { return here > there * (1 + 1e-6); }
  [[nodiscard]] std::string text() const {
    if (here == there || std::abs(gain()) < 0.05) return "same";
    if (std::isinf(here) || there == 0) return "WORSE";
    if (std::isinf(there)) return "all";
    return fmt::format("{:.1f} %", gain());
  }
};

std::vector<Figure> figures(const CascadeAxisDesign& loop) {
  const CascadeLoopEvidence& here = loop.design.evidence;
  const CascadeLoopEvidence& there = loop.published_evidence;
  return {{"Ms - 1", here.margins.Ms - 1, there.margins.Ms - 1},
          {"load: integral", here.load_integral, there.load_integral},
          {"load: peak", here.load_peak, there.load_peak},
          {"noise: value", here.value_noise, there.value_noise},
          {"noise: rate", here.rate_noise, there.rate_noise}};
}

/// By how much the cascade is better than what is published, and where it is not.
std::string verdict(const CascadeReport& report) {
  std::string text = fmt::format("{:<9}", "loop");
  for (const Figure& figure : figures(report.cascade.loops.front()))
    text += fmt::format("{:>16}", figure.name);
  std::string losses;
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    if (!loop.published) continue;
    text += fmt::format("\n{:<9}", to_string(loop.axis));
    if (!loop.published_evidence.margins.stable) {
      text += "      what is published is unstable here: no measure";
      continue;
    }
    for (const Figure& figure : figures(loop)) {
      text += fmt::format("{:>16}", figure.text());
      if (figure.worse())
        losses += fmt::format("{}{} in {}", losses.empty() ? "" : ", ", to_string(loop.axis),
                              figure.name);
    }
  }
  return text + (losses.empty() ? "\nno figure is worse" : "\nWORSE: " + losses);
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
               {"motor_lag_s", *report.specification.lag},
               {"published",
                report.published_source.empty() ? Json(nullptr) : Json(report.published_source)}};
  json["loops"] = Json::array();
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    Json row = gains_json(written(report, loop.axis));
    row.update(evidence_json(loop.design.evidence));
    row["binding"] = loop.design.binding;
    row["highest_rate_crossover"] = finite_or_null(loop.design.highest_rate_crossover);
    row["published"] = nullptr;
    if (loop.published) {
      row["published"] = gains_json(as_published(report, loop.axis));
      row["published"].update(evidence_json(loop.published_evidence));
    }
    json["loops"].push_back(std::move(row));
  }
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
    text += section("beside", comparison_text(report)) + section("lower by", verdict(report));
  const double radius = report.cascade.poles.cwiseAbs().maxCoeff();
  text += section("margins", to_text(report.margins)) +
          section("closed", fmt::format("{}: {} poles of all loops together, the greatest of "
                                        "modulus {:.6f}",
                                        unstable(report) ? "UNSTABLE" : "stable",
                                        report.cascade.poles.size(), radius));
  return text;
}

}  // namespace quadtune::report
