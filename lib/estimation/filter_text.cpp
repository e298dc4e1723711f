// SPDX-License-Identifier: Apache-2.0
// Writes filter models as text files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

std::string numbers(const Eigen::Ref<const Eigen::RowVectorXd>& row) {
  return fmt::format("[{}]", fmt::join(row.begin(), row.end(), ", "));
}

void put_matrix(std::string& text, const std::string& key, const MatrixXd& M) {
  if (M.size() == 0) return;
  std::vector<std::string> rows;
  for (Index i = 0; i < M.rows(); ++i) rows.push_back(numbers(M.row(i)));
  text += fmt::format("{} = [{}]\n", key, internal::joined(rows, ", "));
}

void put_signals(std::string& text, const std::string& key, const std::vector<Signal>& signals) {
  if (signals.empty()) return;
  std::vector<std::string> words;
  words.reserve(signals.size());
  for (const Signal& s : signals)
    words.push_back(quoted(s.unit.empty() ? s.name : fmt::format("{} [{}]", s.name, s.unit)));
  text += fmt::format("{} = [{}]\n", key, internal::joined(words, ", "));
}

/// Writes the terms of one covariance as tables of that name.
class TermWriter {
 public:
  TermWriter(std::string& text, const FilterModel& model, std::string table,
             const std::vector<Signal>& entries)
      : text_(text), model_(model), table_(std::move(table)), entries_(entries) {}

  void write(const CovarianceModel& covariance) {
    if (!covariance.fixed.isZero(0)) {
      std::vector<int> all;
      all.reserve(static_cast<std::size_t>(covariance.size()));
      for (int i = 0; i < static_cast<int>(covariance.size()); ++i) all.push_back(i);
      begin(all);
      text_ += "kind = \"fixed\"\n";
      put_matrix(text_, "covariance", covariance.fixed);
    }
    for (const ScaledCovariance& term : covariance.scaled) write_scaled(term);
    for (const FullCovariance& term : covariance.full) write_full(term);
  }

 private:
  void begin(const std::vector<int>& chosen) {
    std::vector<std::string> names;
    names.reserve(chosen.size());
    for (const int i : chosen) names.push_back(quoted(entries_[static_cast<std::size_t>(i)].name));
    text_ += fmt::format("\n[[{}]]\nentries = [{}]\n", table_, internal::joined(names, ", "));
  }

  void put_parameter(const NoiseParameter& p) {
    text_ += fmt::format("parameter = {}\n", quoted(p.name));
    put_about(p);
    text_ += fmt::format("variance = {}\n", p.start);
    if (p.interval)
      text_ += fmt::format("interval = [{}, {}]\n", p.interval->first, p.interval->second);
  }

  void put_about(const NoiseParameter& p) {
    if (!p.unit.empty()) text_ += fmt::format("unit = {}\n", quoted(p.unit));
    if (p.prior)
      text_ += fmt::format("prior_median = {}\nprior_deviation = {}\n", p.prior->median,
                           p.prior->deviation);
  }

  void write_scaled(const ScaledCovariance& term) {
    std::vector<int> chosen;
    for (Index i = 0; i < term.shape.rows(); ++i)
      if (term.shape(i, i) != 0) chosen.push_back(static_cast<int>(i));
    MatrixXd plain = MatrixXd::Zero(term.shape.rows(), term.shape.cols());
    for (const int i : chosen) plain(i, i) = 1;
    if (plain != term.shape)
      throw InvalidInput("filter model",
                         "a term of a covariance has entries other than 1 on its "
                         "diagonal, which the file format cannot express");
    begin(chosen);
    if (chosen.size() > 1) text_ += "kind = \"shared\"\n";
    put_parameter(model_.parameters[static_cast<std::size_t>(term.parameter)]);
  }

  void write_full(const FullCovariance& term) {
    const auto n = static_cast<int>(term.entries.size());
    const Eigen::VectorXd theta = start_of(model_);
    MatrixXd block(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        block(i, j) = full_entry(theta.data() + term.first_parameter, i, j);
    begin(term.entries);
    text_ += "kind = \"full\"\n";
    put_about(model_.parameters[static_cast<std::size_t>(term.first_parameter)]);
    put_matrix(text_, "covariance", block);
  }

  std::string& text_;
  const FilterModel& model_;
  std::string table_;
  const std::vector<Signal>& entries_;
};

void put_dynamics(std::string& text, const FilterModel& model) {
  if (model.gravity) {
    text += fmt::format("dynamics = \"inertial\"\ngravity_m_per_s2 = {}\n",
                        numbers(model.gravity->transpose()));
    return;
  }
  if (!model.vehicle.empty()) {
    text += fmt::format("dynamics = \"rigid-body\"\nvehicle = {}\n", quoted(model.vehicle));
    return;
  }
  if (model.dt > 0) text += fmt::format("period_s = {}\n", model.dt);
  put_signals(text, "states", model.states);
  put_signals(text, "inputs", model.inputs);
  put_signals(text, "noises", model.noises);
  put_matrix(text, "A", model.A);
  put_matrix(text, "B", model.B);
  put_matrix(text, "G", model.G);
}

}  // namespace

std::string text_of_filter_model(const FilterModel& model,
                                 const std::vector<std::string>& comments) {
  validate(model, "filter model");
  std::string text;
  for (const std::string& line : comments) text += fmt::format("# {}\n", line);
  text += fmt::format("name = {}\n", quoted(model.name));
  if (!model.description.empty())
    text += fmt::format("description = {}\n", quoted(model.description));
  if (!model.verdict.empty()) text += fmt::format("verdict = {}\n", quoted(model.verdict));
  put_dynamics(text, model);
  TermWriter(text, model, "Q", model.noises).write(model.Q);
  for (const FilterSensor& sensor : model.sensors) {
    text += fmt::format("\n[[sensors]]\nname = {}\n", quoted(sensor.name));
    if (model.vehicle.empty()) {
      put_signals(text, "outputs", sensor.outputs);
      put_matrix(text, "C", sensor.C);
      put_matrix(text, "D", sensor.D);
    }
    if (sensor.delay > 0) text += fmt::format("delay_s = {}\n", sensor.delay);
    if (sensor.student > 0) text += fmt::format("student = {}\n", sensor.student);
    if (std::isfinite(sensor.gate)) text += fmt::format("gate = {}\n", sensor.gate);
    TermWriter(text, model, "sensors.R", sensor.outputs).write(sensor.R);
  }
  bool any_diffuse = false, all_diffuse = true;
  for (const bool d : model.diffuse) {
    any_diffuse = any_diffuse || d;
    all_diffuse = all_diffuse && d;
  }
  if (any_diffuse && !all_diffuse)
    throw InvalidInput("filter model",
                       "some states are diffuse and some are not, expected all or "
                       "none because the file format has one setting for all");
  if (!any_diffuse)
    text += fmt::format("\n[initial]\nx = {}\nvariance = {}\n", numbers(model.x0.transpose()),
                        numbers(model.P0.diagonal().transpose()));
  return text;
}

}  // namespace quadtune
