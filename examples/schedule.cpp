// SPDX-License-Identifier: Apache-2.0
/// State feedback over a range of speeds, as a table that flight code interpolates: schedule [FILE]
/// FILE, which ends in .toml or .json, is written if it is named.
/// Exit status: 0 if every point has a gain, 1 if not, 2 and one line for any error.
#include <exception>
#include <fstream>
#include <iostream>
#include <numbers>
#include <quadtune/quadtune.hpp>
#include <string>

int main(int count, char** words) {
  try {
    const quadtune::Vehicle vehicle = quadtune::load_vehicle("crazyflie");
    // The design of one point: all 12 states to the wrench, 200 times a second.
    const quadtune::LqrDesign design = quadtune::usual_lqr(vehicle, 0.005);
    // At each speed the vehicle is trimmed, linearized there, and the Riccati equation solved.
    const quadtune::GainSchedule schedule = quadtune::gain_schedule(
        vehicle, {{quadtune::ScheduleQuantity::speed, {0, 1, 2, 3, 4, 5}}}, design);
    for (Eigen::Index i = 0; i < schedule.size(); ++i) {
      std::cout << "speed " << quadtune::grid_point(schedule.axes, i)(0) << " m/s: ";
      if (schedule.solved(i))
        std::cout << "pitch " << schedule.x0(4, i) * 180 / std::numbers::pi << " deg, residual "
                  << (schedule.residual(i) < 1e-10 ? "below" : "above") << " 1e-10\n";
      else
        std::cout << schedule.culprit[static_cast<std::size_t>(i)] << '\n';
    }
    // Between the points the gains are interpolated. How far is that from solving there?
    const quadtune::ScheduledGain between = schedule.at(Eigen::VectorXd::Constant(1, 2.5));
    const quadtune::GainSchedule exact =
        quadtune::gain_schedule(vehicle, {{quadtune::ScheduleQuantity::speed, {2.5}}}, design);
    if (!between.found()) throw std::runtime_error(between.culprit);
    const Eigen::MatrixXd K = exact.gains(0).K;
    std::cout << "gains at 2.5 m/s: interpolated within " << 100 * (between.K - K).norm() / K.norm()
              << " % of those computed there\n";
    // Outside the grid there are no gains: nothing is extrapolated.
    std::cout << "gains at 9 m/s: " << schedule.at(Eigen::VectorXd::Constant(1, 9)).culprit << '\n';
    if (count > 1) {
      const std::string text =
          quadtune::schedule_text(schedule, quadtune::table_format(words[1], "FILE"));
      std::ofstream file(words[1], std::ios::binary);
      file << text << std::flush;
      if (!file) throw quadtune::FileError(words[1], "cannot be written");
    }
    return schedule.solved_count() == schedule.size() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "schedule: " << error.what() << '\n';
    return 2;
  }
}
