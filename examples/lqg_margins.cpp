// SPDX-License-Identifier: Apache-2.0
/// LQG for a vehicle near hover, with its margins: lqg_margins [NAME|FILE]
/// Exit status: 0 if the loop is stable, 1 if not, 2 and one line for any error.
#include <Eigen/LU>
#include <iostream>
#include <numbers>
#include <quadtune/quadtune.hpp>
#include <stdexcept>

namespace {
/// The margins of each input, with the loops of the other inputs closed.
void print_margins(const char* law, const quadtune::OpenLoop& loop) {
  for (Eigen::Index i = 0; i < loop.size(); ++i) {
    const quadtune::LoopMargins margins = quadtune::loop_margins(loop.channel(i));
    std::cout << law << ' ' << quadtune::ned_convention().wrench[static_cast<std::size_t>(i)].name
              << ": phase margin " << margins.phase_margin * 180 / std::numbers::pi
              << " deg, sensitivity peak " << margins.Ms << '\n';
  }
}

}  // namespace

int main(int count, char** words) {
  try {
    // The vehicle near hover: x' = A x + B u with 12 states and u = [thrust, torques].
    const quadtune::Vehicle vehicle = quadtune::load_vehicle(count > 1 ? words[1] : "mambo");
    quadtune::LinearizeOptions options;
    options.inputs = quadtune::InputKind::wrench;
    const quadtune::Linearization hover =
        quadtune::linearize(vehicle, quadtune::FlightCondition{}, options);
    if (!hover.solved()) throw std::runtime_error(hover.trim.culprit);
    quadtune::ContinuousLti plant = hover.plant;
    // The regulator u = -K x, with weights by Bryson's rule from the limits of the rotors.
    const quadtune::LqrDesign design = quadtune::usual_lqr(vehicle);
    const quadtune::RiccatiResult lqr = quadtune::lqr(plant, {design.Q, design.R, {}});
    if (!lqr.solved()) throw std::runtime_error(lqr.culprit);
    // The filter: position and attitude are measured, and noise acts where the rotors do.
    plant.C = Eigen::MatrixXd::Identity(6, 12);
    const quadtune::KalmanResult filter = quadtune::kalman(
        plant, {plant.B, 0.01 * design.R.inverse(), 1e-6 * Eigen::MatrixXd::Identity(6, 6), {}});
    if (!filter.solved()) throw std::runtime_error(filter.culprit);
    // The loop cut at the rotors: the plant drives the filter, whose estimate drives K.
    const Eigen::MatrixXd LC = filter.L * plant.C, zero = Eigen::MatrixXd::Zero(12, 12);
    quadtune::ContinuousLti loop;
    loop.A =
        (Eigen::MatrixXd(24, 24) << plant.A, zero, LC, plant.A - plant.B * lqr.K - LC).finished();
    loop.B = (Eigen::MatrixXd(24, 4) << plant.B, zero.leftCols(4)).finished();
    loop.C = (Eigen::MatrixXd(4, 24) << zero.topRows(4), lqr.K).finished();
    const quadtune::OpenLoop lqg(loop);
    print_margins("LQR", quadtune::loop_at_inputs(plant, lqr.K));
    print_margins("LQG", lqg);
    const double slowest = lqg.closed_loop_poles().real().maxCoeff();
    std::cout << "slowest pole: LQG " << slowest << " 1/s, LQR " << lqr.poles.real().maxCoeff()
              << " 1/s, filter " << filter.poles.real().maxCoeff() << " 1/s\n";
    return slowest < 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "lqg_margins: " << error.what() << '\n';
    return 2;
  }
}
