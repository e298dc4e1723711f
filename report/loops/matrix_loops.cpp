// SPDX-License-Identifier: Apache-2.0
#include "report/loops/matrix_loops.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/control/pid.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/systems/matrix_loop.hpp"
#include "quadtune/workbench/systems/matrix_lqr.hpp"
#include "quadtune/workbench/systems/system_report.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

Json cost_json(const SampledLqr& sampled) {
  const Eigen::MatrixXd& N = sampled.weights.N;
  return {{"A", internal::matrix_to_json(sampled.plant.A, "A")},
          {"B", internal::matrix_to_json(sampled.plant.B, "B")},
          {"Q", internal::matrix_to_json(sampled.weights.Q, "Q")},
          {"R", internal::matrix_to_json(sampled.weights.R, "R")},
          {"N", internal::matrix_to_json(N, "N")}};
}

/// The matrix, or "none" if it is empty.
std::string matrix_or_none(const Eigen::MatrixXd& M) { return M.size() > 0 ? plain(M) : "none"; }

DiscreteTransferFunction discrete_pid(const PidGains& gains, double dt, PidMethod method) {
  return pid_transfer_function(pid_settings(gains, dt, method), PidChannel::error);
}

/// " + 0.5 e[k-1]"; empty for 0.
std::string term(double factor, const std::string& signal, bool is_first) {
  if (factor == 0) return "";
  const std::string size = std::abs(factor) == 1 ? "" : fmt::format("{:.9g} ", std::abs(factor));
  const char* sign = factor < 0 ? (is_first ? "-" : " - ") : (is_first ? "" : " + ");
  return sign + size + signal;
}

std::string sampled_name(const char* signal, Eigen::Index steps) {
  return steps == 0 ? fmt::format("{}[k]", signal) : fmt::format("{}[k-{}]", signal, steps);
}

std::string deviations_text(const MatrixLqgReport& report) {
  if (!std::isfinite(report.cost)) return section("mean cost", "not computed");
  return section("mean cost", number(report.cost) + (report.dt > 0 ? " per step" : "")) +
         section("rms", fmt::format("states {}; inputs {}", numbers(report.state_rms),
                                    numbers(report.input_rms)));
}

}  // namespace

std::string peaks_text(const MarginsReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.loops.size(); ++i) {
    const LoopMargins& m = report.loops[i];
    text += fmt::format("{}{}Ms {} at {} rad/s, Mt {} at {} rad/s", text.empty() ? "" : "\n",
                        report.loops.size() > 1 ? report.names[i] + ": " : "", figure(m.Ms, ".4g"),
                        figure(m.w_Ms, ".4g"), figure(m.Mt, ".4g"), figure(m.w_Mt, ".4g"));
    if (m.stable)
      text += fmt::format(
          "; gain within the disk {:.4g} to {}", m.disk.gain_low,
          std::isfinite(m.disk.gain_high) ? fmt::format("{:.4g}", m.disk.gain_high) : "any");
  }
  return text;
}

Json to_json(const FrequencyDataReport& report) {
  Json json = to_json(report.margins);
  json["samples"] = report.samples;
  json["w_min"] = report.w_min;
  json["w_max"] = report.w_max;
  json["notes"] = report.notes;
  return json;
}

std::string to_text(const FrequencyDataReport& report) {
  return section("loop", fmt::format("{} frequencies from {} to {} rad/s", report.samples,
                                     number(report.w_min), number(report.w_max))) +
         section("margins", to_text(report.margins)) + section("peaks", peaks_text(report.margins));
}

Json to_json(const MatrixLqrReport& report) {
  Json json = to_json(report.lqr);
  json["K"] = internal::matrix_to_json(report.K, "K");
  if (report.K_int.size()) json["K_int"] = internal::matrix_to_json(report.K_int, "K_int");
  if (report.K_past.size()) json["K_past"] = internal::matrix_to_json(report.K_past, "K_past");
  if (report.sampled) json["sampled"] = cost_json(*report.sampled);
  return json;
}

std::string to_text(const MatrixLqrReport& report, bool with_sampled) {
  std::string text;
  if (report.K_int.size() || report.K_past.size()) {
    text = section("state gain", plain(report.K));
    if (report.K_int.size()) text += section("integral K", plain(report.K_int));
    if (report.K_past.size()) text += section("past K", plain(report.K_past));
  }
  text += to_text(report.lqr);
  if (!with_sampled || !report.sampled) return text;
  const SampledLqr& sampled = *report.sampled;
  return text + section("sampled A", plain(sampled.plant.A)) +
         section("sampled B", plain(sampled.plant.B)) +
         section("sampled Q", plain(sampled.weights.Q)) +
         section("sampled R", plain(sampled.weights.R)) +
         section("sampled N", matrix_or_none(sampled.weights.N));
}

Json to_json(const MatrixLqgReport& report) {
  Json json = {{"status", to_string(report.lqr.status)},
               {"K", internal::matrix_to_json(report.lqr.K, "K")},
               {"S", internal::matrix_to_json(report.lqr.X, "S")},
               {"L", internal::matrix_to_json(report.filter.L, "L")}};
  if (report.dt > 0) json["M"] = internal::matrix_to_json(report.filter.M, "M");
  json["P"] = internal::matrix_to_json(report.filter.P, "P");
  json["controller"] = {{"A", internal::matrix_to_json(report.A, "A")},
                        {"B", internal::matrix_to_json(report.B, "B")},
                        {"C", internal::matrix_to_json(report.C, "C")},
                        {"D", internal::matrix_to_json(report.D, "D")},
                        {"dt", report.dt > 0 ? Json(report.dt) : Json()}};
  json["poles"] = internal::poles_to_json(report.poles, "poles");
  json["cost"] = internal::finite_or_null(report.cost);
  json["rms"] = {{"states", internal::vector_to_json(report.state_rms, "states")},
                 {"inputs", internal::vector_to_json(report.input_rms, "inputs")}};
  json["margins"] = to_json(report.margins);
  json["residual"] = {{"lqr", report.lqr.residual}, {"filter", report.filter.residual}};
  return json;
}

std::string to_text(const MatrixLqgReport& report) {
  std::string text = section("gain K", plain(report.lqr.K));
  if (report.dt > 0) text += section("filter M", plain(report.filter.M));
  text += section(report.dt > 0 ? "predictor L" : "filter L", plain(report.filter.L));
  text += section("controller", "from y to -u, the states are the estimates") +
          section("A", plain(report.A)) + section("B", plain(report.B)) +
          section("C", plain(report.C)) + section("D", plain(report.D));
  return text + section("poles", pole_table(report.poles, report.dt)) + deviations_text(report) +
         section("margins", to_text(report.margins)) +
         section("evidence", fmt::format("residuals {:.2g} (lqr), {:.2g} (filter)",
                                         report.lqr.residual, report.filter.residual));
}

Json to_json(const PolePlacement& placement) {
  return {{"status", to_string(placement.status)},
          {"K", internal::matrix_to_json(placement.K, "K")},
          {"poles", internal::poles_to_json(placement.poles, "poles")},
          {"error", placement.error}};
}

std::string to_text(const PolePlacement& placement, double dt) {
  return section("gain K", plain(placement.K)) + section("poles", pole_table(placement.poles, dt)) +
         section("evidence", fmt::format("largest error of a pole {:.2g}", placement.error));
}

Json to_json(const SystemReport& report) {
  Json json = {{"time", report.dt > 0 ? "discrete" : "continuous"},
               {"dt", report.dt > 0 ? Json(report.dt) : Json()},
               {"stable", report.peak.stable},
               {"poles", internal::poles_to_json(report.poles, "poles")},
               {"zeros", internal::poles_to_json(report.zeros.zeros, "zeros")},
               {"rank", report.zeros.rank}};
  json["dc_gain"] =
      report.dc_gain.size() ? internal::matrix_to_json(report.dc_gain, "dc_gain") : Json();
  json["peak_gain"] = internal::finite_or_null(report.peak.gain);
  json["hinf_norm"] = report.peak.stable ? internal::finite_or_null(report.peak.gain) : Json();
  json["hinf_frequency"] = internal::finite_or_null(report.peak.w);
  json["h2_norm"] = internal::finite_or_null(report.h2);
  return json;
}

std::string to_text(const SystemReport& report) {
  const bool discrete = report.dt > 0;
  std::string zeros;
  for (const std::complex<double>& zero : report.zeros.zeros)
    zeros += (zeros.empty() ? "" : ", ") + number(zero.real()) +
             (zero.imag() != 0 ? fmt::format(" {} {}i", zero.imag() < 0 ? "-" : "+",
                                             number(std::abs(zero.imag())))
                               : "");
  const std::string peak =
      std::isfinite(report.peak.gain)
          ? fmt::format("{:.9g} at {}", report.peak.gain,
                        std::isfinite(report.peak.w) ? number(report.peak.w) + " rad/s"
                                                     : "infinite frequency")
          : fmt::format("infinite at {} rad/s", number(report.peak.w));
  return section("system", fmt::format("{}, {}",
                                       discrete ? "discrete, every " + number(report.dt) + " s"
                                                : "continuous",
                                       report.peak.stable ? "stable" : "UNSTABLE")) +
         section("poles", pole_table(report.poles, report.dt)) +
         section("zeros", zeros.empty() ? "none" : zeros) +
         section("gain at 0", report.dc_gain.size() ? plain(report.dc_gain) : "infinite") +
         section(report.peak.stable ? "H-infinity" : "peak gain", peak) +
         section("H2 norm",
                 std::isfinite(report.h2) ? fmt::format("{:.9g}", report.h2) : "infinite");
}

Json discrete_pid_json(const PidGains& gains, double dt, PidMethod method) {
  const DiscreteTransferFunction C = discrete_pid(gains, dt, method);
  return {{"dt", dt},
          {"method", to_string(method)},
          {"num", internal::vector_to_json(C.num, "num")},
          {"den", internal::vector_to_json(C.den, "den")}};
}

std::string discrete_pid_text(const PidGains& gains, double dt, PidMethod method) {
  const DiscreteTransferFunction C = discrete_pid(gains, dt, method);
  const Eigen::Index n = C.den.size() - 1;
  const double lead = C.den[0];
  std::string right;
  for (Eigen::Index j = 1; j <= n; ++j)
    right += term(-C.den[j] / lead, sampled_name("u", j), right.empty());
  const Eigen::Index lag = C.den.size() - C.num.size();
  for (Eigen::Index j = 0; j < C.num.size(); ++j)
    right += term(C.num[j] / lead, sampled_name("e", j + lag), right.empty());
  return fmt::format("every {} s by {}\nu[k] = {}", number(dt), to_string(method),
                     right.empty() ? "0" : right);
}

}  // namespace quadtune::report
