// SPDX-License-Identifier: Apache-2.0
/// `quadtune lqr V`: the designs for a vehicle.
#pragma once

#include <string>

#include "arguments/flown_lqr_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune::cli {

/// Designs on the flown plant and prints the result.
void run_flown_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                   Context& context);

/// Designs a matrix on the states for the flown plant and prints the result.
/// @param asks_for_inputs  whether --inputs was given
void run_matrix_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                    bool asks_for_inputs, Context& context);

/// Designs on the ideal plant at a trim and prints the result.
/// @param evidence  value of --evidence, or empty
void run_ideal_lqr(const LqrArguments& arguments, const std::string& evidence, Context& context);

/// Designs over a grid of trims and prints a summary; with --json or -o it prints the table
/// instead.
/// @throws NoSolution  if no point has a gain.
void run_schedule(const LqrArguments& arguments, const std::string& grid, Context& context);

/// Requires that the equation was solved.
/// @param plant  source of the model: a vehicle or "--A".
/// @throws NoSolution  with the reason of the failure
void require_solved(const RiccatiResult& riccati, const std::string& plant);

}  // namespace quadtune::cli
