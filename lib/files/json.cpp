// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune::internal {

Json number_to_json(double number, const std::string& name) {
  if (!std::isfinite(number))
    throw InvalidInput(name, fmt::format("{} cannot be written, expected a finite number", number));
  return number;
}

Json finite_or_null(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json matrix_to_json(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& name) {
  require_finite(M, "json", name);
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < M.cols(); ++j) row.push_back(M(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json vector_to_json(const Eigen::Ref<const Eigen::VectorXd>& v, const std::string& name) {
  require_finite(v, "json", name);
  Json entries = Json::array();
  for (const double entry : v) entries.push_back(entry);
  return entries;
}

Json poles_to_json(const Eigen::Ref<const Eigen::VectorXcd>& poles, const std::string& name) {
  Json entries = Json::array();
  for (const std::complex<double>& pole : poles)
    entries.push_back({number_to_json(pole.real(), name), number_to_json(pole.imag(), name)});
  return entries;
}

Json signals_to_json(const std::vector<Signal>& signals) {
  Json entries = Json::array();
  for (const Signal& signal : signals)
    entries.push_back({{"name", signal.name}, {"unit", signal.unit}});
  return entries;
}

const Json& member(const Json& json, const std::string& key, const std::string& where) {
  if (!json.is_object())
    throw InvalidInput(where, fmt::format("is {}, expected an object", json.type_name()));
  const Json* const found = json.find(key);
  if (found == nullptr) throw InvalidInput(where, fmt::format("has no \"{}\"", key));
  return *found;
}

double number_from_json(const Json& json, const std::string& where) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw InvalidInput(where, fmt::format("is {}, expected a finite number", json_text(json)));
  return json.get<double>();
}

std::string string_from_json(const Json& json, const std::string& where) {
  if (!json.is_string())
    throw InvalidInput(where, fmt::format("is {}, expected text", json.type_name()));
  return json.get<std::string>();
}

Eigen::VectorXd vector_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of numbers", json.type_name()));
  Eigen::VectorXd v(static_cast<Eigen::Index>(json.size()));
  for (std::size_t i = 0; i < json.size(); ++i)
    v(static_cast<Eigen::Index>(i)) = number_from_json(json[i], fmt::format("{}[{}]", where, i));
  return v;
}

Eigen::MatrixXd matrix_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of rows", json.type_name()));
  Eigen::MatrixXd M(static_cast<Eigen::Index>(json.size()), 0);
  for (std::size_t i = 0; i < json.size(); ++i) {
    const Eigen::VectorXd row = vector_from_json(json[i], fmt::format("{}[{}]", where, i));
    if (i == 0) M.resize(M.rows(), row.size());
    if (row.size() != M.cols())
      throw InvalidInput(fmt::format("{}[{}]", where, i),
                         fmt::format("has {}, expected {} as in the rows before it",
                                     internal::counted(row.size(), "entry", "entries"), M.cols()));
    M.row(static_cast<Eigen::Index>(i)) = row.transpose();
  }
  return M;
}

Eigen::VectorXcd poles_from_json(const Json& json, const std::string& where) {
  const Eigen::MatrixXd pairs = matrix_from_json(json, where);
  if (pairs.rows() > 0 && pairs.cols() != 2)
    throw InvalidInput(
        where, fmt::format("has rows of {} numbers, expected [real, imaginary]", pairs.cols()));
  Eigen::VectorXcd poles(pairs.rows());
  for (Eigen::Index i = 0; i < pairs.rows(); ++i) poles(i) = {pairs(i, 0), pairs(i, 1)};
  return poles;
}

std::vector<Signal> signals_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of signals", json.type_name()));
  std::vector<Signal> signals;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string here = fmt::format("{}[{}]", where, i);
    signals.push_back({string_from_json(member(json[i], "name", here), here + ".name"),
                       string_from_json(member(json[i], "unit", here), here + ".unit")});
  }
  return signals;
}

}  // namespace quadtune::internal
