// SPDX-License-Identifier: Apache-2.0
// A Kalman filter with its model and noise, as stored in gains.json.
#include "filter_matrices.hpp"
#include "json/to_json.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::exports {

using internal::matrix_to_json;
using internal::number_to_json;
using internal::signals_to_json;

Json filter_to_json(const KalmanFilter& filter) {
  Json json;
  json["name"] = filter.name;
  json["dt_s"] = number_to_json(filter.model.dt, filter.name + ".dt");
  json["states"] = signals_to_json(filter.model.states);
  json["inputs"] = signals_to_json(filter.model.inputs);
  json["outputs"] = signals_to_json(filter.model.outputs);
  each_matrix(filter, [&](const char* key, const Eigen::MatrixXd& M) {
    json[key] = matrix_to_json(M, filter.name + "." + key);
  });
  return json;
}

KalmanFilter filter_from_json(const Json& json, const std::string& where) {
  const auto at = [&](const char* key) -> const Json& {
    return internal::member(json, key, where);
  };
  const auto path = [&](const char* key) { return where + "." + key; };
  KalmanFilter filter;
  filter.name = internal::string_from_json(at("name"), path("name"));
  filter.model.dt = internal::number_from_json(at("dt_s"), path("dt_s"));
  filter.model.states = internal::signals_from_json(at("states"), path("states"));
  filter.model.inputs = internal::signals_from_json(at("inputs"), path("inputs"));
  filter.model.outputs = internal::signals_from_json(at("outputs"), path("outputs"));
  each_matrix(filter, [&](const char* key, Eigen::MatrixXd& M) {
    M = internal::matrix_from_json(at(key), path(key));
  });
  return filter;
}

}  // namespace quadtune::exports
