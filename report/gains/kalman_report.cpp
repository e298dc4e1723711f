// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "report/gains/gains.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {

internal::Json to_json(const KalmanResult& result, double dt) {
  const bool is_discrete = dt > 0;
  internal::Json json;
  json["status"] = to_string(result.status);
  if (is_discrete) json["M"] = internal::matrix_to_json(result.M, "M");
  json["L"] = internal::matrix_to_json(result.L, "L");
  json["P"] = internal::matrix_to_json(result.P, "P");
  if (is_discrete) json["Z"] = internal::matrix_to_json(result.Z, "Z");
  json["poles"] = internal::poles_to_json(result.poles, "poles");
  json["residual"] = internal::number_to_json(result.residual, "residual");
  json["rcond"] = internal::number_to_json(result.rcond, "rcond");
  json["iterations"] = result.iterations;
  json["warning"] = result.warning;
  return json;
}

std::string to_text(const KalmanResult& result, double dt) {
  const bool is_discrete = dt > 0;
  std::string text;
  if (is_discrete) text += section("filter M", plain(result.M));
  text += section(is_discrete ? "predictor L" : "gain L", plain(result.L)) +
          section("P", plain(result.P));
  if (is_discrete) text += section("Z", plain(result.Z));
  return text + section("poles", pole_table(result.poles, dt)) +
         section("evidence",
                 fmt::format("residual {:.2g}, rcond {:.2g}", result.residual, result.rcond));
}

}  // namespace quadtune::report
