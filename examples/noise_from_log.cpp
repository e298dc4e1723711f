// SPDX-License-Identifier: Apache-2.0
/// The noise covariances of a Kalman filter from a log, with intervals and a verdict:
/// noise_from_log LOG [MODEL]
/// MODEL is a filter model, by default the built-in "altitude": acceleration in, height measured.
/// The channels of the log are found by the names of the model's signals.
/// Exit status: 0 if the covariances can be relied on, 1 if not, 2 and one line for any error.
#include <exception>
#include <iostream>
#include <quadtune/quadtune.hpp>
#include <stdexcept>
#include <string>
#include <utility>

int main(int count, char** words) {
  try {
    if (count < 2) throw std::runtime_error("which log? noise_from_log LOG [MODEL]");
    quadtune::NoiseLogOptions sources;
    sources.logs = {words[1]};
    quadtune::NoiseLogs logs = quadtune::read_noise_logs(
        quadtune::load_filter_model(count > 2 ? words[2] : "altitude"), sources);
    std::cout << logs.logs[0].samples() << " instants in " << logs.logs[0].seconds() << " s\n";

    // The covariances that make the log most likely. The last fifth of the log is kept from the
    // search, to see whether the filter is better on data that the search has not seen.
    const quadtune::TunedNoise tuned = quadtune::tune_noise(std::move(logs));
    const quadtune::NoiseTuning& result = tuned.tuning;
    for (const quadtune::FittedParameter& found : result.fit.parameters)
      std::cout << found.name << ": " << found.value << ' ' << found.unit << ", 95 % within "
                << found.low << " ... " << found.high << '\n';

    // Innovations of a consistent filter are as large as their covariance states, and white.
    for (const quadtune::InnovationStatistics& output : result.after.outputs)
      std::cout << output.output << ": mean of e^2/S " << output.size << " over " << output.samples
                << " innovations\n";
    std::cout << "log-likelihood an innovation on the part kept from the search: "
              << result.holdout.before << " before, " << result.holdout.after << " after\n";
    std::cout << "verdict: " << quadtune::to_string(result.verdict) << '\n';
    for (const std::string& reason : result.reasons) std::cout << "  " << reason << '\n';
    return result.verdict == quadtune::CheckVerdict::pass ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "noise_from_log: " << error.what() << '\n';
    return 2;
  }
}
