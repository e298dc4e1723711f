// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/filter_covariance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

constexpr double kSameTime = 1e-9;     // times closer than this are equal [s]
constexpr double kMaxSamples = 20000;  // of one sensor

/// [Φ, ∫Φ Q Φᵀ] for integrators with A⁴ = 0 and decaying states that drive no other.
template <int N>
struct Interval {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  double length = -1;
  Matrix phi, noise;

  static Matrix transition(const Matrix& A, double h) {
    // e^(A h) = I + A h + (A h)²/2 + (A h)³/6
    const Matrix Ah = A * h;
    const Matrix square = Ah * Ah;
    return Matrix::Identity() + Ah + square / 2 + square * Ah / 6;
  }
  Interval() = default;
  Interval(const Matrix& A, const Matrix& Q, const Vector& decay, double h)
      : length(h), phi(transition(A, h)) {
    // The four-point Gauss-Legendre rule is exact: the integrand has degree 6.
    constexpr std::array<double, 4> node = {-0.8611363115940526, -0.3399810435848563,
                                            0.3399810435848563, 0.8611363115940526};
    constexpr std::array<double, 4> weight = {0.3478548451374538, 0.6521451548625461,
                                              0.6521451548625461, 0.3478548451374538};
    noise.setZero();
    for (std::size_t i = 0; i < 4; ++i) {
      const Matrix at = transition(A, h / 2 * (1 + node[i]));
      noise += h / 2 * weight[i] * (at * Q * at.transpose());
    }
    for (int i = 0; i < N; ++i) {
      if (!(decay(i) > 0)) continue;
      phi(i, i) = std::exp(-decay(i) * h);
      noise(i, i) = Q(i, i) * -std::expm1(-2 * decay(i) * h) / (2 * decay(i));
    }
  }
};

/// A sensor's clock in the filter.
template <int N>
struct Clock {
  double period = 0, delay = 0, R = 0;
  Eigen::Matrix<double, N, 1> H;
  std::int64_t next = 0;

  [[nodiscard]] double time() const { return static_cast<double>(next) * period; }
};

template <int N>
class Filter {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  /// @param model  at most N states; unused states of the filter stay 0
  Filter(const ErrorModel& model, double begin, double end)
      : A_(padded(model.A)), Q_(padded(model.Q)), P_(padded(model.P0)), now_(begin) {
    decay_.setZero();
    decay_.head(model.decay.size()) = model.decay;
    for (const LinearSensor& sensor : model.sensors) {
      const double lumped = std::max(1.0, std::ceil((end - begin) * sensor.rate / kMaxSamples));
      Clock<N> clock;
      clock.period = lumped / sensor.rate;
      clock.delay = sensor.delay;
      clock.R = sensor.R / lumped;
      clock.H.setZero();
      clock.H.head(sensor.H.size()) = sensor.H;
      clock.next = static_cast<std::int64_t>(std::ceil(begin / clock.period - kSameTime));
      clocks_.push_back(clock);
    }
  }

  /// Processes every sample that was taken up to `time` and has arrived by `arrived`.
  void run(double time, double arrived) {
    for (;;) {
      Clock<N>* first = nullptr;
      for (Clock<N>& clock : clocks_)
        if (clock.time() <= time + kSameTime && clock.time() + clock.delay <= arrived + kSameTime &&
            (first == nullptr || clock.time() < first->time()))
          first = &clock;
      if (first == nullptr) return;
      predict(first->time());
      correct(*first);
      ++first->next;
    }
  }

  void predict(double time) {
    const double h = time - now_;
    if (!(h > kSameTime)) return;
    const Interval<N>& step = interval(h);
    P_ = step.phi * P_ * step.phi.transpose() + step.noise;
    for (Vector& x : columns_) x = step.phi * x;
    now_ = time;
  }

  /// Starts to track the covariance with the first state's current error.
  void follow() { columns_.push_back(P_.col(0)); }
  void forget_columns() { columns_.clear(); }

  [[nodiscard]] double variance() const { return std::max(P_(0, 0), 0.0); }
  [[nodiscard]] const Matrix& covariance() const { return P_; }
  [[nodiscard]] double covariance(std::size_t column) const { return columns_[column](0); }

 private:
  const Interval<N>& interval(double h) {
    for (const Interval<N>& known : known_)
      if (std::abs(known.length - h) < 1e-12) return known;
    oldest_ = (oldest_ + 1) % known_.size();
    return known_[oldest_] = Interval<N>(A_, Q_, decay_, h);
  }

  static Matrix padded(const Eigen::MatrixXd& matrix) {
    Matrix result = Matrix::Zero();
    result.topLeftCorner(matrix.rows(), matrix.cols()) = matrix;
    return result;
  }

  void correct(const Clock<N>& clock) {
    const Vector PH = P_ * clock.H;
    const double S = clock.H.dot(PH) + clock.R;
    if (!(S > 0)) return;  // a perfect sample of a known quantity has no information
    const Vector K = PH / S;
    P_ -= K * PH.transpose();
    P_ = ((P_ + P_.transpose()) / 2).eval();
    for (int i = 0; i < N; ++i) P_(i, i) = std::max(P_(i, i), 0.0);
    for (Vector& x : columns_) x -= K * clock.H.dot(x);
  }

  Matrix A_, Q_, P_;
  Vector decay_;
  double now_;
  std::vector<Clock<N>> clocks_;
  std::vector<Vector> columns_;
  std::array<Interval<N>, 6> known_;
  std::size_t oldest_ = 0;
};

template <int N>
ErrorCovariance run(const ErrorModel& model, double begin, const std::vector<double>& times,
                    const std::vector<std::size_t>& starts) {
  ErrorCovariance result;
  const auto n = static_cast<Eigen::Index>(times.size());
  result.starts = starts;
  result.variance.setConstant(n, model.P0(0, 0));
  result.covariance.setZero(std::ssize(starts), n);
  if (times.empty()) return result;
  double horizon = 0;
  for (const LinearSensor& sensor : model.sensors) horizon = std::max(horizon, sensor.delay);
  Filter<N> past(model, begin, times.back());
  Eigen::VectorXd of_past = Eigen::VectorXd::Zero(n);  // variance at the horizon
  std::size_t followed = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double time = times[static_cast<std::size_t>(k)];
    if (time - horizon > begin) {
      past.run(time - horizon, time);
      past.predict(time - horizon);
    }
    const bool begins = followed < starts.size() && starts[followed] == static_cast<std::size_t>(k);
    if (begins) {
      past.follow();
      ++followed;
    }
    for (std::size_t j = 0; j < followed; ++j)
      result.covariance(static_cast<Eigen::Index>(j), k) = past.covariance(j);
    of_past(k) = past.variance();
    if (time <= begin) continue;
    if (horizon == 0) {
      result.variance(k) = past.variance();
      continue;
    }
    Filter<N> now = past;
    now.forget_columns();
    now.run(time, time);
    now.predict(time);
    result.variance(k) = now.variance();
  }
  // The errors of the outputs are correlated like those at the horizon.
  for (std::size_t j = 0; j < followed; ++j) {
    const auto row = static_cast<Eigen::Index>(j), start = static_cast<Eigen::Index>(starts[j]);
    for (Eigen::Index k = start; k < n; ++k) {
      const double sizes = std::sqrt(of_past(start) * of_past(k));
      result.covariance(row, k) *=
          sizes > 0 ? std::sqrt(result.variance(start) * result.variance(k)) / sizes : 0;
    }
  }
  return result;
}

void require(bool holds, const std::string& what) {
  if (!holds) throw InvalidInput("error model", what);
}

void validate(const ErrorModel& model, double begin, const std::vector<double>& times,
              const std::vector<std::size_t>& starts) {
  const Eigen::Index n = model.A.rows();
  require(n >= 1 && n <= kMaxErrorStates,
          fmt::format("it has {} states, expected 1 to {}", n, kMaxErrorStates));
  for (const auto& [matrix, name] :
       {std::pair(&model.A, "A"), std::pair(&model.Q, "Q"), std::pair(&model.P0, "P0")})
    require(matrix->rows() == n && matrix->cols() == n && matrix->allFinite(),
            fmt::format("{} is {}x{} or not finite, expected a finite {}x{}", name, matrix->rows(),
                        matrix->cols(), n, n));
  require(model.decay.size() == 0 || model.decay.size() == n,
          fmt::format("decay has {} entries, expected {} or none", model.decay.size(), n));
  for (Eigen::Index i = 0; i < model.decay.size(); ++i) {
    require(model.decay(i) >= 0 && std::isfinite(model.decay(i)),
            fmt::format("decay {} is {} 1/s, expected 0 or more", i + 1, model.decay(i)));
    require(model.decay(i) == 0 || (model.A.row(i).isZero(0) && model.A.col(i).isZero(0)),
            fmt::format("state {} decays and is coupled with another by A", i + 1));
  }
  require(std::isfinite(begin) && std::is_sorted(times.begin(), times.end()) &&
              (times.empty() || (std::isfinite(times.front()) && std::isfinite(times.back()))),
          "the times are not finite or do not increase");
  require(std::is_sorted(starts.begin(), starts.end()) &&
              (starts.empty() || starts.back() < times.size()),
          "the starts do not increase or are not indices of times");
  for (const LinearSensor& sensor : model.sensors) {
    require(sensor.rate > 0 && std::isfinite(sensor.rate),
            fmt::format("the rate of a sensor is {} Hz, expected more than 0", sensor.rate));
    require(sensor.delay >= 0 && std::isfinite(sensor.delay),
            fmt::format("the delay of a sensor is {} s, expected 0 or more", sensor.delay));
    require(sensor.R >= 0 && std::isfinite(sensor.R),
            fmt::format("the variance of a sensor is {}, expected 0 or more", sensor.R));
    require(sensor.H.size() == n && sensor.H.allFinite(),
            fmt::format("H of a sensor has {} entries or is not finite, expected {}",
                        sensor.H.size(), n));
  }
}

/// Calls `job` with the smallest compiled number of states that suffices.
template <class Job>
auto with_size(Eigen::Index states, const Job& job) {
  if (states <= 2) return job(std::integral_constant<int, 2>());
  if (states <= 4) return job(std::integral_constant<int, 4>());
  if (states <= 7) return job(std::integral_constant<int, 7>());
  return job(std::integral_constant<int, kMaxErrorStates>());
}

}  // namespace

ErrorCovariance best_filter_error(const ErrorModel& model, double begin,
                                  const std::vector<double>& times,
                                  const std::vector<std::size_t>& starts) {
  validate(model, begin, times, starts);
  return with_size(model.A.rows(), [&](auto size) {
    return run<decltype(size)::value>(model, begin, times, starts);
  });
}

Eigen::MatrixXd best_filter_covariance(const ErrorModel& model, double duration) {
  validate(model, 0, {duration}, {});
  return with_size(model.A.rows(), [&](auto size) -> Eigen::MatrixXd {
    Filter<decltype(size)::value> filter(model, 0, duration);
    filter.run(duration, duration);
    filter.predict(duration);
    return filter.covariance().topLeftCorner(model.A.rows(), model.A.rows());
  });
}

}  // namespace quadtune
