// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/verify/certify.hpp"
#include "report/loops/loops.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

bool is_fixed(const UncertainParameter& p) { return p.low == p.high; }

Json point_json(const LoopFamily& family, const Eigen::VectorXd& values) {
  Json point = Json::object();
  for (std::size_t i = 0; i < family.parameters.size(); ++i)
    point[family.parameters[i].name] = values(static_cast<Eigen::Index>(i));
  return point;
}

std::string box_text(const LoopFamily& family) {
  std::string text;
  for (const UncertainParameter& p : family.parameters) {
    const std::string unit = p.unit.empty() ? "" : " " + p.unit;
    text += fmt::format(
        "{:<12}{}\n", p.name,
        is_fixed(p) ? fmt::format("{:g}{}", p.low, unit)
                    : fmt::format("{:g} ... {:g}{}, nominal {:g}", p.low, p.high, unit, p.nominal));
  }
  text.pop_back();
  return text;
}

Json box_json(const LoopFamily& family) {
  Json box = Json::object();
  for (const UncertainParameter& p : family.parameters)
    box[p.name] = {{"low", p.low}, {"nominal", p.nominal}, {"high", p.high}, {"unit", p.unit}};
  return box;
}

/// The part of the box at which a proof stopped.
std::string where_text(const StabilityProof& proof) {
  std::string text =
      fmt::format("delay {:.5g} ... {:.5g} s", proof.where.delay_low, proof.where.delay_high);
  for (std::size_t i = 0; i < proof.numbers.size(); ++i)
    text += fmt::format(", {} {:.5g} ... {:.5g} of nominal", proof.numbers[i],
                        proof.where.low(static_cast<Eigen::Index>(i)),
                        proof.where.high(static_cast<Eigen::Index>(i)));
  return text;
}

std::string proof_text(const CertifiedLaw& law) {
  const StabilityProof& proof = law.robustness.proof;
  if (proof.proved())
    return fmt::format(
        "stable in the whole box{}: {} Lyapunov functions, each on a part of it\n"
        "every loop contracts by at least {:.3g} per period, in the norm of its part",
        law.family.max_scale < 1 ? ", as far as the vehicle can hover" : "", proof.proved_boxes,
        proof.gap);
  return fmt::format(
      "{}: {}\nthere: {}",
      proof.status == StabilityProofStatus::unstable ? "an unstable loop was found" : "not proved",
      proof.culprit, where_text(proof));
}

std::string stability_text(const StabilityProof& proof) {
  std::string text;
  for (const std::string& part : proof.parts) text += (text.empty() ? "" : " | ") + part;
  return text;
}

std::string scale_text(const CertifiedLaw& law) {
  const Robustness& r = law.robustness;
  std::string text =
      fmt::format("proved up to {:.4g} times the box around nominal", r.proved_scale);
  if (std::isfinite(r.found_scale))
    return text + fmt::format("\nunstable at {:.4g} times: {}", r.found_scale,
                              describe(law.family, r.found.parameters));
  return text + fmt::format("\nnothing unstable found up to {:.4g} times: {}", law.family.max_scale,
                            law.family.max_scale_reason);
}

std::string flown_text(const CertifiedLaw& law) {
  const FlownBox& flown = *law.flown;
  if (!flown.worst) return "not analysed: " + flown.why;
  return fmt::format(
      "{} vehicles of the box with their sensors and the estimator {}: {}\n"
      "worst: {}; {}",
      flown.vehicles, flown.worst->estimator, law.flown_unstable() ? "UNSTABLE" : "stable",
      describe(*flown.worst), describe(law.family, flown.parameters));
}

Json flown_json(const CertifiedLaw& law) {
  if (!law.flown) return nullptr;
  const FlownBox& flown = *law.flown;
  if (!flown.worst) return {{"why", flown.why}};
  return {{"vehicles", flown.vehicles},
          {"estimator", flown.worst->estimator},
          {"sensors", flown.worst->sensors},
          {"stable", !law.flown_unstable()},
          {"radius", std::abs(flown.worst->mode.z)},
          {"mode", describe(*flown.worst)},
          {"parameters", point_json(law.family, flown.parameters)}};
}

std::string law_text(const CertifiedLaw& law) {
  const Robustness& r = law.robustness;
  return section("law", fmt::format("{}, every {} s", law.name, number(law.dt))) +
         section("box", box_text(law.family)) + section("loops", stability_text(r.proof)) +
         section("proof", proof_text(law)) +
         section("worst found", fmt::format("largest |z| {:.9f}{}: {}", r.worst.radius,
                                            r.worst.unstable() ? ", UNSTABLE" : "",
                                            describe(law.family, r.worst.parameters))) +
         section("bracket", scale_text(law)) + (law.flown ? section("flown", flown_text(law)) : "");
}

Json proof_json(const StabilityProof& proof) {
  Json json = {{"status", to_string(proof.status)},
               {"boxes", proof.boxes},
               {"proved_boxes", proof.proved_boxes},
               {"gap", proof.gap},
               {"coupling", proof.coupling},
               {"culprit", proof.culprit},
               {"where", nullptr}};
  if (proof.proved()) return json;
  Json numbers = Json::object();
  for (std::size_t i = 0; i < proof.numbers.size(); ++i)
    numbers[proof.numbers[i]] = {proof.where.low(static_cast<Eigen::Index>(i)),
                                 proof.where.high(static_cast<Eigen::Index>(i))};
  json["where"] = {{"part", proof.part},
                   {"delay_s", {proof.where.delay_low, proof.where.delay_high}},
                   {"numbers", numbers}};
  return json;
}

Json law_json(const CertifiedLaw& law) {
  const Robustness& r = law.robustness;
  const bool found = std::isfinite(r.found_scale);
  return {{"name", law.name},
          {"dt", law.dt},
          {"box", box_json(law.family)},
          {"parts", r.proof.parts},
          {"proof", proof_json(r.proof)},
          {"worst",
           {{"radius", r.worst.radius},
            {"unstable", r.worst.unstable()},
            {"parameters", point_json(law.family, r.worst.parameters)}}},
          {"scale",
           {{"proved", r.proved_scale},
            {"found", r.found_scale},
            {"found_at", found ? point_json(law.family, r.found.parameters) : Json(nullptr)},
            {"greatest", law.family.max_scale},
            {"greatest_reason", law.family.max_scale_reason}}},
          {"flown", flown_json(law)},
          {"proved", law.proved()},
          {"reason", law.reason()}};
}

}  // namespace

Json to_json(const CertifyReport& report) {
  Json laws = Json::array();
  for (const CertifiedLaw& law : report.laws) laws.push_back(law_json(law));
  return {{"directory", report.directory},
          {"vehicle", report.vehicle},
          {"laws", laws},
          {"verdict", report.verdict()}};
}

std::string to_text(const CertifyReport& report) {
  std::string text = section(
      "certify",
      fmt::format("{}, hover of {}: linear sampled loops, each parameter of the box constant",
                  report.directory, report.vehicle));
  for (const CertifiedLaw& law : report.laws) text += law_text(law);
  return text + section("verdict", report.verdict());
}

}  // namespace quadtune::report
