// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/systems/system_report.hpp"

#include <Eigen/Eigenvalues>
#include <type_traits>

#include "quadtune/frequency_response.hpp"

namespace quadtune {
namespace {

template <class Lti>
SystemReport report_of(const Lti& system) {
  SystemReport report;
  validate(system, "system");
  if constexpr (std::is_same_v<Lti, DiscreteLti>) report.dt = system.dt;
  report.poles = system.A.eigenvalues();
  report.zeros = invariant_zeros(system);
  const Eigen::MatrixXcd at_rest = FrequencyResponse(system).at(0);
  // A pole that differs from 0, or from 1, by rounding only has a response without meaning.
  constexpr double kNoGain = 1e14;
  if (at_rest.allFinite() && at_rest.cwiseAbs().maxCoeff() < kNoGain)
    report.dc_gain = at_rest.real();
  report.peak = peak_gain(system);
  report.h2 = h2_norm(system);
  return report;
}

}  // namespace

SystemReport system_report(const std::variant<ContinuousLti, DiscreteLti>& system) {
  return std::visit([](const auto& lti) { return report_of(lti); }, system);
}

}  // namespace quadtune
