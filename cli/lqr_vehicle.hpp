// SPDX-License-Identifier: Apache-2.0
/// `quadtune lqr V`: the designs for a vehicle.
#pragma once

#include <string>

#include "arguments/flown_lqr_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/synthesis/riccati.hpp"

namespace quadtune::cli {

/// Designs on the plant that flies, and prints.
void run_flown_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                   Context& context);

/// Designs a matrix on the states for the plant that flies, and prints.
/// @param asks_for_inputs  whether --inputs came
void run_matrix_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                    bool asks_for_inputs, Context& context);

/// Designs about a trim, without what flies, and prints.
/// @param evidence  the word of --evidence, or empty
void run_ideal_lqr(const LqrArguments& arguments, const std::string& evidence, Context& context);

/// Designs over a grid of flights, and prints: a summary, or with --json or -o the table.
/// @throws NoSolution  if no point has a gain.
void run_schedule(const LqrArguments& arguments, const std::string& grid, Context& context);

/// Ends with the culprit unless the equation was solved.
/// @param plant  what gave the model: a vehicle or "--A".
/// @throws NoSolution
void require_solved(const RiccatiResult& riccati, const std::string& plant);

}  // namespace quadtune::cli
