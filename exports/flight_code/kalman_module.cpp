// SPDX-License-Identifier: Apache-2.0
#include "flight_code/kalman_module.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "quadtune/estimation/steady_filter.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune::exports {
namespace {

/// Checks that the matrices of a filter have consistent shapes and finite entries.
void require_whole(const KalmanFilter& filter) {
  const std::string where = "filter '" + filter.name + "'";
  const Eigen::Index states = filter.model.A.rows(), inputs = filter.model.B.cols(),
                     measurements = filter.model.C.rows();
  const auto require = [&](const char* name, const Eigen::MatrixXd& M, Eigen::Index rows,
                           Eigen::Index cols) {
    require_shape(M, rows, cols, where, name, "as the filter's model");
    require_finite(M, where, name);
  };
  require("A", filter.model.A, states, states);
  require("B", filter.model.B, states, inputs);
  require("C", filter.model.C, measurements, states);
  require("R", filter.R, measurements, measurements);
  require("M", filter.M, states, measurements);
  require("L", filter.L, states, measurements);
}

/// "x = (z [m], vz [m/s])"
std::string vector_in_words(const char* name, const std::vector<Signal>& signals) {
  std::vector<std::string> words;
  words.reserve(signals.size());
  for (const Signal& signal : signals)
    words.push_back(signal.unit.empty() ? signal.name
                                        : fmt::format("{} [{}]", signal.name, signal.unit));
  return fmt::format("{} = ({})", name, in_comment(internal::joined(words, ", ")));
}

template <class T>
class KalmanRun {
 public:
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  KalmanRun(const KalmanFilter& filter, std::size_t index) : filter_(filter), index_(index) {}

  std::string text() {
    constexpr int kPeriods = 100;
    const Vector start = random(filter_.model.A.rows(), [](Eigen::Index) { return 1; });
    std::string text = fmt::format("filter {}", index_);
    add(text, start);
    text += '\n';
    SteadyFilterState<T> state = steady_filter_start<T>(filter_, start);
    for (int k = 0; k < kPeriods; ++k) {
      const Vector y = measurement(state, k);
      const Vector u = input(k);
      const Vector estimate = correct<T>(filter_, state, y);
      predict<T>(filter_, state, u);
      std::string line;
      for (const Vector* of : {&y, &u, &estimate}) add(line, *of);
      text += line.substr(1) + '\n';
    }
    return text;
  }

 private:
  /// The filter's expected measurement plus noise; sometimes no measurement.
  Vector measurement(const SteadyFilterState<T>& state, int k) {
    Vector y = random(filter_.model.C.rows(),
                      [&](Eigen::Index i) { return 2 * std::sqrt(filter_.R(i, i)); });
    for (Eigen::Index i = 0; i < y.size(); ++i)
      for (Eigen::Index j = 0; j < state.x.size(); ++j)
        y(i) += T(filter_.model.C(i, j)) * state.x(j);
    if (k % 10 == 7) y(k % y.size()) = std::numeric_limits<T>::quiet_NaN();
    return y;
  }
  Vector input(int k) {
    Vector u = random(filter_.model.B.cols(), [](Eigen::Index) { return 1; });
    if (k % 20 == 13 && u.size() > 0) u(k % u.size()) = std::numeric_limits<T>::infinity();
    return u;
  }
  /// Uniformly distributed within -size(i) ... size(i).
  Vector random(Eigen::Index entries, const auto& size) {
    Vector x(entries);
    for (Eigen::Index i = 0; i < entries; ++i) {
      const RandomPair<1> pair = random_uniform(RandomSource<1>{}, 0, drawn_++);
      x(i) = static_cast<T>((2 * lane(pair.first, 0) - 1) * size(i));
    }
    return x;
  }
  static void add(std::string& line, const Vector& x) {
    for (const T number : x) fmt::format_to(std::back_inserter(line), " {}", number);
  }

  const KalmanFilter& filter_;
  std::size_t index_;
  std::uint64_t drawn_ = 0;
};

}  // namespace

KalmanSizes kalman_sizes(const std::vector<KalmanFilter>& filters) {
  KalmanSizes sizes;
  for (const KalmanFilter& filter : filters) {
    sizes.states = std::max(sizes.states, static_cast<int>(filter.model.A.rows()));
    sizes.inputs = std::max(sizes.inputs, static_cast<int>(filter.model.B.cols()));
    sizes.measurements = std::max(sizes.measurements, static_cast<int>(filter.model.C.rows()));
  }
  return sizes;
}

void choose_kalman(const std::vector<KalmanFilter>& filters, SourceChoices& choices) {
  if (filters.empty()) return;
  for (const KalmanFilter& filter : filters) require_whole(filter);
  const KalmanSizes sizes = kalman_sizes(filters);
  choices.features.insert("KALMAN");
  choices.sizes["KALMAN_FILTERS"] = static_cast<int>(filters.size());
  choices.sizes["KALMAN_STATES"] = sizes.states;
  choices.sizes["KALMAN_INPUTS"] = sizes.inputs;
  choices.sizes["KALMAN_MEASUREMENTS"] = sizes.measurements;
  std::vector<std::string> lines;
  lines.reserve(filters.size());
  for (const KalmanFilter& filter : filters)
    lines.push_back(fmt::format(
        "{} '{}', every {} s:\n *   {}\n *   {}\n *   {}", lines.size(), in_comment(filter.name),
        filter.model.dt, vector_in_words("x", filter.model.states),
        vector_in_words("u", filter.model.inputs), vector_in_words("y", filter.model.outputs)));
  choices.words["FILTERS"] = internal::joined(lines, "\n * ");
}

std::string kalman_recording(const std::vector<KalmanFilter>& filters, bool double_precision) {
  std::string text =
      "# A recorded run of the steady Kalman filters. `filter`, the number of the filter, and the\n"
      "# states it starts with; then a line for each of its periods: measurements y, inputs u, "
      "and\n"
      "# the estimate that the filter gives. nan: no measurement.\n";
  for (std::size_t i = 0; i < filters.size(); ++i)
    text += double_precision ? KalmanRun<double>(filters[i], i).text()
                             : KalmanRun<float>(filters[i], i).text();
  return text;
}

}  // namespace quadtune::exports
