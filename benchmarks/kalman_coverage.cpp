// SPDX-License-Identifier: Apache-2.0
#include "kalman_coverage.hpp"

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <vector>

#include "plants/filter_models.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/tuning/noise_fit.hpp"
#include "wall_time.hpp"

namespace quadtune::bench {
namespace {

constexpr int kLogs = 500;

struct Tally {
  int held = 0;
  int seen = 0;       // number of fits with an interval
  double error = 0;   // sum of the stated standard errors
  double square = 0;  // sum of the squared errors
};

std::vector<Tally> tally(const FilterModel& model, int samples, double dt) {
  std::mt19937_64 random(3);
  const Eigen::VectorXd truth = start_of(model);
  std::vector<Tally> tallies(model.parameters.size());
  NoiseFitOptions options;
  options.starts = 1;
  for (int log = 0; log < kLogs; ++log) {
    const NoiseFit fit = fit_noise(
        InnovationLikelihood(model, {testing::simulated(model, truth, samples, dt, random)}),
        options);
    for (std::size_t i = 0; i < tallies.size(); ++i) {
      const FittedParameter& p = fit.parameters[i];
      const double is = std::exp(truth(static_cast<Eigen::Index>(i)));
      if (p.low <= is && is <= p.high) ++tallies[i].held;
      if (p.verdict != ParameterVerdict::seen) continue;
      ++tallies[i].seen;
      tallies[i].error += p.standard_error;
      tallies[i].square += std::pow(std::log(p.value / is), 2);
    }
  }
  return tallies;
}

}  // namespace

void print_coverage() {
  fmt::print(
      "| model | parameter | truth | samples | intervals with the truth | mean standard error | "
      "error found | goal 93 to 97 % |\n|---|---|---:|---:|---:|---:|---:|---|\n");
  struct Case {
    const char* model;
    int samples;
    double dt;
  };
  const Wall wall = wall_of(
      [] {
        for (const Case& c : {Case{"local-level", 500, 1}, Case{"constant-velocity", 1000, 0.1},
                              Case{"altitude", 4000, 0.005}, Case{"velocity-xy", 1000, 0.005},
                              Case{"attitude", 20000, 0.01}}) {
          const FilterModel model = load_filter_model(c.model);
          const std::vector<Tally> tallies = tally(model, c.samples, c.dt);
          for (std::size_t i = 0; i < tallies.size(); ++i) {
            const Tally& t = tallies[i];
            const double share = 100.0 * t.held / kLogs;
            fmt::print("| {} | {} | {:g} | {} | {:.1f} %{} | {:.3f} | {:.3f} | {} |\n", c.model,
                       model.parameters[i].name, model.parameters[i].start, c.samples, share,
                       t.seen < kLogs ? fmt::format(" ({} of {} seen)", t.seen, kLogs) : "",
                       t.error / t.seen, std::sqrt(t.square / t.seen),
                       share >= 93 && share <= 97 ? "met" : "not met");
          }
        }
      },
      1);
  fmt::print("\nlogarithms of variances; {:.0f} s in all\n", wall.median);
}

}  // namespace quadtune::bench
