// SPDX-License-Identifier: Apache-2.0
/// quadtune discretize: one system by one method.
#include "quadtune/discretize/discretize.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "matrix_arguments.hpp"
#include "number_arguments.hpp"
#include "print.hpp"
#include "program.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string A, B, C, D, method = "zoh";
  double dt = 0;
};

ContinuousLti read_plant(const Options& options, std::istream& in) {
  ContinuousLti plant;
  plant.A = require_matrix(options.A, in, "discretize", "--A");
  plant.B = require_matrix(options.B, in, "discretize", "--B");
  plant.C = options.C.empty() ? Eigen::MatrixXd::Identity(plant.A.rows(), plant.A.rows()).eval()
                              : read_matrix(options.C, in);
  plant.D = options.D.empty() ? Eigen::MatrixXd::Zero(plant.C.rows(), plant.B.cols()).eval()
                              : read_matrix(options.D, in);
  return plant;
}

void print(const DiscreteLti& plant, const std::string& method, Context& context) {
  if (context.json) {
    internal::Json json;
    json["A"] = internal::matrix_to_json(plant.A, "A");
    json["B"] = internal::matrix_to_json(plant.B, "B");
    json["C"] = internal::matrix_to_json(plant.C, "C");
    json["D"] = internal::matrix_to_json(plant.D, "D");
    json["dt"] = plant.dt;
    json["method"] = method;
    context.out << internal::readable(json) << "\n";
    return;
  }
  context.out << section("A", plain(plant.A)) << section("B", plain(plant.B))
              << section("C", plain(plant.C)) << section("D", plain(plant.D))
              << section("dt", number(plant.dt) + " s, " + method);
}

}  // namespace

Verb discretize_verb() {
  return {
      "discretize", "--A FILE --B FILE [--C FILE --D FILE] --dt T [--method NAME]",
      "sample a continuous system",
      "quadtune discretize --A docs/examples/A.txt --B docs/examples/B.txt --dt 0.01 --method "
      "tustin",
      [](CLI::App& app) -> Action {
        auto options = std::make_shared<Options>();
        app.add_option("--A", options->A, "dynamics (nx x nx)")->type_name("FILE");
        app.add_option("--B", options->B, "inputs (nx x nu)")->type_name("FILE");
        app.add_option("--C", options->C, "outputs (ny x nx); the states")->type_name("FILE");
        app.add_option("--D", options->D, "feed-through (ny x nu); zero")->type_name("FILE");
        CLI::Option* dt = add_number(app, "--dt", options->dt, "sample period [s]")->type_name("T");
        app.add_option("--method", options->method, "zoh (default), euler or tustin")
            ->type_name("NAME");
        return [options, dt](Context& context) {
          if (dt->count() == 0)
            throw UsageError(
                "quadtune discretize: --dt is missing, expected a sample period "
                "in seconds",
                "--dt");
          require_positive(options->dt, "discretize", "--dt");
          const DiscretizationMethod method = discretization_method(options->method, "--method");
          const ContinuousLti plant = read_plant(*options, context.in);
          print(discretize(plant, options->dt, method), options->method, context);
        };
      }};
}

}  // namespace quadtune::cli
