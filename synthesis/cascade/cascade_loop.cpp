// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/cascade_loop.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <ostream>

#include "lyapunov/eigenvalues.hpp"
#include "margins/frequency_grid.hpp"
#include "pid/gain_gaps.hpp"
#include "pid/golden_section.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using internal::GainInterval;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void require_plant(const CascadePlant& plant) {
  const char* where = "cascade loop";
  validate(plant, where);
  if (plant.B.cols() != 1 || plant.C.rows() != 2)
    throw InvalidInput(where, fmt::format("{} inputs and {} outputs, expected the command, and the "
                                          "value with its rate",
                                          plant.B.cols(), plant.C.rows()));
  if (plant.D.size() > 0 && !plant.D.isZero(0))
    throw InvalidInput(where,
                       "D is not 0, expected a value and a rate that follow the command "
                       "later, because the loop is algebraic else");
}

/// The integral's response and gain at once: I[k] = s[k] + now e[k], s[k+1] = s[k] + dt e[k].
struct Integral {
  double dt;
  double now;

  Integral(PidMethod method, double period)
      : dt(period), now(pid_quadrature<double>(method).now * period) {}

  [[nodiscard]] Complex at(double w) const {
    // dt/(z - 1) + now, uncancelled: z - 1 = 2j sin(w dt/2) e^(jw dt/2).
    const double half = 0.5 * w * dt;
    return now + dt * std::polar(1.0, -half) / Complex(0, 2 * std::sin(half));
  }
};

/// The plant with Kd of its rate fed back: input and outputs as before.
CascadePlant with_rate_closed(CascadePlant plant, double Kd) {
  plant.A -= Kd * plant.B * plant.C.row(1);
  return plant;
}

/// States of the plant and, with Ki, of the integral; the input is added to the command, or is the
/// set point.
CascadePlant closed(const CascadePlant& plant, const PidGains& gains, PidMethod method,
                    bool set_point) {
  const Integral integral(method, plant.dt);
  const double at_once = gains.Kp + gains.Ki * integral.now;
  const Index n = plant.A.rows();
  const Index ni = gains.Ki != 0 ? 1 : 0;
  CascadePlant loop;
  loop.dt = plant.dt;
  loop.outputs = plant.outputs;
  loop.A = MatrixXd::Zero(n + ni, n + ni);
  loop.A.topLeftCorner(n, n) =
      plant.A - plant.B * (at_once * plant.C.row(0) + gains.Kd * plant.C.row(1));
  loop.B = MatrixXd::Zero(n + ni, 1);
  loop.B.topRows(n) = set_point ? MatrixXd(plant.B * at_once) : plant.B;
  loop.C = MatrixXd::Zero(2, n + ni);
  loop.C.leftCols(n) = plant.C;
  loop.D = MatrixXd::Zero(2, 1);
  if (ni > 0) {
    loop.A.topRightCorner(n, 1) = plant.B;
    loop.A.bottomLeftCorner(1, n) = -gains.Ki * plant.dt * plant.C.row(0);
    loop.A(n, n) = 1;
    if (set_point) loop.B(n, 0) = gains.Ki * plant.dt;
  }
  return loop;
}

double spectral_radius(const MatrixXd& A) { return internal::eigenvalues(A).cwiseAbs().maxCoeff(); }

struct StepOfLoad {
  double peak = kInfinity;  ///< greatest |value|
  double left = kInfinity;  ///< |value| that stays
};

/// What a unit step at the input makes of the value.
StepOfLoad follow_load(const CascadePlant& loop) {
  const Index n = loop.A.rows();
  const double radius = spectral_radius(loop.A);
  if (!(radius < 1)) return {};
  const Eigen::VectorXd rest =
      (MatrixXd::Identity(n, n) - loop.A).partialPivLu().solve(loop.B).col(0);
  StepOfLoad step;
  step.left = std::abs(loop.C.row(0).dot(rest));
  step.peak = step.left;
  constexpr double kSettled = 1e-4;
  constexpr double kMostSteps = 1e5;
  const double steps = std::min(kMostSteps, std::ceil(std::log(kSettled) / std::log(radius)));
  // z = (x, 1), z[k+1] = M z[k]: kBlock steps at once, y[k+j] = (C M^j) z[k].
  constexpr Index kBlock = 32;
  MatrixXd M = MatrixXd::Zero(n + 1, n + 1);
  M.topLeftCorner(n, n) = loop.A;
  M.topRightCorner(n, 1) = loop.B.col(0);
  M(n, n) = 1;
  MatrixXd rows = MatrixXd::Zero(kBlock, n + 1);
  rows.row(0).head(n) = loop.C.row(0);
  rows.row(0) = (rows.row(0) * M).eval();
  // Doubling: rows m + 1 … 2m are the rows 1 … m times M^m.
  for (Index m = 1; m < kBlock; m *= 2) {
    rows.middleRows(m, m) = rows.topRows(m) * M;
    M = (M * M).eval();
  }
  Eigen::VectorXd z = Eigen::VectorXd::Unit(n + 1, n);
  Eigen::VectorXd y(kBlock), next(n + 1);
  for (Index k = 0; k < static_cast<Index>(steps); k += kBlock) {
    y.noalias() = rows * z;
    step.peak = std::max(step.peak, y.cwiseAbs().maxCoeff());
    next.noalias() = M * z;
    z.swap(next);
  }
  return step;
}

/// Responses of one plant on a grid, at which all gains are tried.
class LoopResponses {
 public:
  /// @param slowest  [rad/s] that matters; the grid begins there
  LoopResponses(const CascadePlant& plant, PidMethod method, double slowest)
      : plant_(plant), response_(plant), integral_(method, plant.dt), method_(method) {
    constexpr double kMostDecades = 8;  // below, a sampled integrator is lost in rounding
    constexpr int kPerDecade = 60;
    const double nyquist = std::numbers::pi / plant.dt;
    const double decades = std::clamp(std::log10(nyquist / slowest), 2.0, kMostDecades);
    const int count = static_cast<int>(std::ceil(decades * kPerDecade));
    grid_.reserve(static_cast<std::size_t>(count) + 1);
    for (int k = count; k >= 0; --k)
      grid_.push_back(nyquist * std::pow(10.0, -double(k) / kPerDecade));
    points_.reserve(grid_.size());
    for (const double w : grid_) points_.push_back(at(w));
  }

  struct Point {
    Complex value;     ///< of the plant
    Complex rate;      ///< of the plant
    Complex integral;  ///< of the controller's, per Ki
  };

  [[nodiscard]] Point at(double w) const {
    const Eigen::MatrixXcd y = response_.at(w);
    return {y(0, 0), y(1, 0), integral_.at(w)};
  }

  [[nodiscard]] const std::vector<double>& grid() const { return grid_; }
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  [[nodiscard]] const CascadePlant& plant() const { return plant_; }
  [[nodiscard]] PidMethod method() const { return method_; }

  [[nodiscard]] bool stable(const PidGains& gains) const {
    return spectral_radius(closed(plant_, gains, method_, false).A) < 1 - 1e-12;
  }

  /// The greatest |f(point) S| of a loop.
  template <class F>
  [[nodiscard]] double peak(const PidGains& gains, const F& f) const {
    const auto size = [&](const Point& p) {
      const Complex L = (gains.Kp + gains.Ki * p.integral) * p.value + gains.Kd * p.rate;
      return std::sqrt(std::norm(f(p)) / std::norm(1.0 + L));
    };
    std::vector<double> values;
    values.reserve(points_.size());
    for (const Point& p : points_) values.push_back(size(p));
    return internal::refine_peak([&](double w) { return size(at(w)); }, grid_, values, 1e-5).first;
  }

  [[nodiscard]] StepOfLoad load(const PidGains& gains) const {
    return follow_load(closed(plant_, gains, method_, false));
  }
  [[nodiscard]] double Ms(const PidGains& gains) const {
    return peak(gains, [](const Point&) { return Complex(1); });
  }
  [[nodiscard]] double value_noise(const PidGains& gains) const {
    return peak(gains, [&](const Point& p) { return gains.Kp + gains.Ki * p.integral; });
  }
  [[nodiscard]] double tracking_peak(const PidGains& gains) const {
    return peak(gains,
                [&](const Point& p) { return (gains.Kp + gains.Ki * p.integral) * p.value; });
  }

 private:
  CascadePlant plant_;
  FrequencyResponse response_;
  Integral integral_;
  PidMethod method_;
  std::vector<double> grid_;  ///< [rad/s] up to Nyquist
  std::vector<Point> points_;
};

/// Well below the slowest pole of the closed loop [rad/s].
double slowest_of(const CascadePlant& plant, const PidGains& gains, PidMethod method) {
  double slowest = std::numbers::pi / plant.dt;
  for (const Complex& z : internal::eigenvalues(closed(plant, gains, method, false).A))
    if (std::abs(z) > 0) slowest = std::min(slowest, std::abs(std::log(z)) / plant.dt);
  return 0.03 * slowest;
}

CascadeLoopEvidence evidence_of(const CascadePlant& plant, const PidGains& gains,
                                PidMethod method) {
  const LoopResponses responses(plant, method, slowest_of(plant, gains, method));
  CascadeLoopEvidence evidence;
  evidence.margins = loop_margins(OpenLoop(cut_at_command(plant, gains, method)));
  evidence.rate = loop_margins(OpenLoop(cut_at_command(plant, {0, 0, gains.Kd, 0}, method)));
  evidence.bandwidth = loop_margins(OpenLoop(cut_at_command(with_rate_closed(plant, gains.Kd),
                                                            {gains.Kp, gains.Ki, 0, 0}, method)))
                           .crossover;
  evidence.load_integral = gains.Ki != 0 && evidence.margins.stable ? 1 / gains.Ki : kInfinity;
  const StepOfLoad load = responses.load(gains);
  evidence.load_peak = load.peak;
  evidence.load_left = gains.Ki != 0 && std::isfinite(load.left) ? 0 : load.left;
  evidence.tracking_peak = responses.tracking_peak(gains);
  evidence.value_noise = responses.value_noise(gains);
  evidence.rate_noise = std::abs(gains.Kd) * evidence.margins.Ms;
  return evidence;
}

/// log of a gain that no Kp and Kd within the bounds have. Below it, points are told apart by how
/// far the load's peak is from its bound, and far below, where not even a gain is left, by how far
/// the others are.
constexpr double kLoadTooHigh = -1e3;
constexpr double kNoRoom = -2e3;

/// How near the search comes to the best Kp and Kd, relative. What it misses of Ki is as little;
/// the bounds are kept all the same, for Ki is computed anew at every point.
constexpr double kKpWidth = 1e-6;
constexpr double kKdWidth = 1e-5;

class Search {
 public:
  Search(const LoopResponses& responses, const CascadeLoopBounds& bounds)
      : responses_(responses), bounds_(bounds) {}

  /// With an integral Kp; without one it is what is looked for.
  struct Point {
    double log_Kp = 0;
    double log_Kd = 0;
  };

  /// log of the greatest Ki, or Kp without an integral; not above kLoadTooHigh where there is none.
  [[nodiscard]] double log_greatest(const Point& x) {
    const PidGains base = gains(x, -kInfinity);
    forbidden_.clear();
    const auto& points = responses_.points();
    for (std::size_t k = 0; k < points.size(); ++k)
      forbid_at(base, responses_.grid()[k], points[k], forbidden_);
    double reached = 0;
    const std::vector<GainInterval> gaps = internal::gaps_between(forbidden_, reached);
    for (std::size_t k = gaps.size(); k-- > 0;) {
      const double found = end_of(gaps[k], base);
      const PidGains all = gains(x, found);
      // Between two frequencies of the grid more may be forbidden.
      if (!responses_.stable(all) || violation(all) > 1e-7) continue;
      if (!std::isfinite(bounds_.load_peak_max)) return found;
      const double excess = std::log(responses_.load(all).peak / bounds_.load_peak_max);
      return excess <= 0 ? found : kLoadTooHigh - excess;
    }
    return kNoRoom - std::max(violation(base), 0.0);
  }

  [[nodiscard]] PidGains gains(const Point& x, double log_found) const {
    const double found = std::exp(log_found);
    const double Kd = std::exp(x.log_Kd);
    return bounds_.integral ? PidGains{std::exp(x.log_Kp), found, Kd, 0}
                            : PidGains{found, 0, Kd, 0};
  }

  /// The best of a scan over Kd downwards from `high_Kd`, unless it is fixed, and over value's
  /// parts that are up to eighty times slower than `fastest` [rad/s].
  [[nodiscard]] Point scan(double high_Kd, bool fixed, double fastest) {
    constexpr int kKd = 24;
    constexpr int kKp = 30;
    Point best;
    double greatest = -kInfinity;
    for (int k = 0; k < (fixed ? 1 : kKd); ++k)
      for (int i = 0; i < (bounds_.integral ? kKp : 1); ++i) {
        const double log_Kd = std::log(high_Kd) - 0.15 * k;
        const Point x{log_Kd + std::log(fastest) - 0.15 * i, log_Kd};
        const double found = log_greatest(x);
        if (!(found > greatest)) continue;
        greatest = found;
        best = x;
      }
    return best;
  }

  /// Over Kp for every Kd, and over Kd up to `log_Kd_max` unless it is fixed.
  [[nodiscard]] Point climb(Point x, bool fixed, double log_Kd_max) {
    const auto at_Kd = [&](double log_Kd) {
      Point here{x.log_Kp, std::min(log_Kd, log_Kd_max)};
      if (bounds_.integral) {
        here.log_Kp = internal::climb_from(
            [&](double log_Kp) {
              return log_greatest({log_Kp, here.log_Kd});
            },
            x.log_Kp, 0.2, kKpWidth);
        x.log_Kp = here.log_Kp;
      }
      return here;
    };
    if (!fixed)
      x.log_Kd = std::min(log_Kd_max, internal::climb_from(
                                          [&](double log_Kd) {
                                            // Beyond the end it falls, so that the search turns
                                            // back.
                                            return log_greatest(at_Kd(log_Kd)) -
                                                   std::max(0.0, log_Kd - log_Kd_max);
                                          },
                                          x.log_Kd, 0.2, kKdWidth));
    return at_Kd(x.log_Kd);
  }

 private:
  void forbid_at(const PidGains& base, double w, const LoopResponses::Point& p,
                 std::vector<GainInterval>& all) const {
    const Complex value_slope = bounds_.integral ? p.integral : 1.0;  // of the value's part
    const internal::AffineResponse returned{1.0 + base.Kp * p.value + base.Kd * p.rate,
                                            value_slope * p.value};
    const double least = std::max(1 / bounds_.Ms_max, base.Kd / bounds_.rate_noise_max);
    internal::forbid(returned, {}, least, w, all);
    const auto bound = [&](double most, Complex through) {
      if (std::isfinite(most))
        internal::forbid(returned, {base.Kp * through / most, value_slope * through / most}, 0, w,
                         all);
    };
    bound(bounds_.value_noise_max, 1);
    bound(bounds_.tracking_max, p.value);
  }

  /// log of the end of a gap, between the frequencies of the grid, and a hair below it.
  [[nodiscard]] double end_of(const GainInterval& gap, const PidGains& base) const {
    const double nyquist = responses_.grid().back();
    const auto end = [&](double log_w) {
      const double w = std::min(std::exp(log_w), nyquist);
      std::vector<GainInterval> here;
      forbid_at(base, w, responses_.at(w), here);
      double least = kInfinity;
      for (const GainInterval& f : here)
        if (f.low > gap.low) least = std::min(least, f.low);
      return -least;
    };
    const double log_w = internal::climb_from(end, std::log(gap.w), 0.04, 1e-5);
    return std::log(std::min(gap.high, -end(log_w))) - 1e-9;
  }

  /// log of how far the worst bound is exceeded, ≤ 0 within all.
  [[nodiscard]] double violation(const PidGains& g) const {
    const double Ms = responses_.Ms(g);
    double worst = std::max(Ms / bounds_.Ms_max, g.Kd * Ms / bounds_.rate_noise_max);
    if (std::isfinite(bounds_.value_noise_max))
      worst = std::max(worst, responses_.value_noise(g) / bounds_.value_noise_max);
    if (std::isfinite(bounds_.tracking_max))
      worst = std::max(worst, responses_.tracking_peak(g) / bounds_.tracking_max);
    return std::isfinite(worst) ? std::log(worst) : 1e2;
  }

  const LoopResponses& responses_;
  CascadeLoopBounds bounds_;
  std::vector<GainInterval> forbidden_;  ///< kept, so that it is not allocated anew
};

void require_bounds(const CascadeLoopBounds& bounds, double dt) {
  const char* where = "cascade loop";
  const double nyquist = std::numbers::pi / dt;
  if (!(bounds.rate_crossover >= 0) || !(bounds.rate_crossover < nyquist))
    throw InvalidInput(where, fmt::format("crossover of the rate is {} rad/s, expected more than 0 "
                                          "and less than pi/dt = {:.6g}",
                                          bounds.rate_crossover, nyquist));
  if (!(bounds.Ms_max > 1) || !(bounds.tracking_max > 1))
    throw InvalidInput(
        where, fmt::format("Ms_max is {} and tracking_max {}, expected more than 1 because an "
                           "integral makes both at least 1",
                           bounds.Ms_max, bounds.tracking_max));
  if (!(bounds.value_noise_max > 0) || !(bounds.rate_noise_max > 0) ||
      !(bounds.rate_crossover_max > 0))
    throw InvalidInput(where, "a bound on noise or crossover is not positive");
}

/// The highest frequency at which the rate's part alone may cross 1 with |S| up to Ms.
double highest_rate_crossover(const LoopResponses& responses, double Ms) {
  const auto keeps = [&](double w) {
    const double Kd = 1 / std::abs(responses.at(w).rate);
    const PidGains gains{0, 0, Kd, 0};
    if (!(responses.Ms(gains) <= Ms)) return false;
    // The value is not fed back, so its integral leaves a pole at 1; all others are inside.
    const Eigen::VectorXcd poles =
        internal::eigenvalues(closed(responses.plant(), gains, responses.method(), false).A);
    return (poles.cwiseAbs().array() < 1 + 1e-6).all();
  };
  const std::vector<double>& grid = responses.grid();
  std::size_t k = 0;
  while (k < grid.size() && keeps(grid[k])) ++k;
  if (k == 0) return 0;
  if (k == grid.size()) return grid.back();
  double low = grid[k - 1];
  double high = grid[k];
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (keeps(middle) ? low : high) = middle;
  }
  return low;
}

/// By the evidence, which looks at other frequencies than the search and by other means.
bool kept(const CascadeLoopBounds& bounds, const CascadeLoopEvidence& evidence) {
  constexpr double kSlack = 1 + 1e-4;
  return evidence.margins.stable && evidence.margins.Ms <= kSlack * bounds.Ms_max &&
         evidence.tracking_peak <= kSlack * bounds.tracking_max &&
         evidence.value_noise <= kSlack * bounds.value_noise_max &&
         evidence.rate_noise <= kSlack * bounds.rate_noise_max;
}

std::string in_words(const CascadeLoopBounds& bounds) {
  std::string text = fmt::format("Ms <= {:.6g}", bounds.Ms_max);
  const auto add = [&](const char* name, double bound) {
    if (std::isfinite(bound)) text += fmt::format(", {} <= {:.4g}", name, bound);
  };
  add("tracking peak", bounds.tracking_max);
  add("load peak", bounds.load_peak_max);
  add("value noise", bounds.value_noise_max);
  add("rate noise", bounds.rate_noise_max);
  return text;
}

}  // namespace

DiscreteLti cut_at_command(const CascadePlant& plant, const PidGains& gains, PidMethod method) {
  require_plant(plant);
  const Integral integral(method, plant.dt);
  const Index n = plant.A.rows();
  const Index ni = gains.Ki != 0 ? 1 : 0;
  DiscreteLti loop;
  loop.dt = plant.dt;
  loop.A = MatrixXd::Zero(n + ni, n + ni);
  loop.A.topLeftCorner(n, n) = plant.A;
  loop.B = MatrixXd::Zero(n + ni, 1);
  loop.B.topRows(n) = plant.B;
  loop.C = MatrixXd::Zero(1, n + ni);
  loop.C.leftCols(n) =
      (gains.Kp + gains.Ki * integral.now) * plant.C.row(0) + gains.Kd * plant.C.row(1);
  loop.D = MatrixXd::Zero(1, 1);
  if (ni > 0) {
    loop.A.bottomLeftCorner(1, n) = gains.Ki * plant.dt * plant.C.row(0);
    loop.A(n, n) = 1;
    loop.C(0, n) = 1;
  }
  return loop;
}

CascadePlant closed_at_command(const CascadePlant& plant, const PidGains& gains, PidMethod method) {
  require_plant(plant);
  return closed(plant, gains, method, true);
}

CascadeLoopEvidence cascade_loop_evidence(const CascadePlant& plant, const PidGains& gains,
                                          PidMethod method) {
  require_plant(plant);
  return evidence_of(plant, gains, method);
}

constexpr internal::EnumName<CascadeLoopStatus> kCascadeLoopStatuses[] = {
    {CascadeLoopStatus::not_run, "not run"},
    {CascadeLoopStatus::solved, "solved"},
    {CascadeLoopStatus::crossover_out_of_reach, "crossover out of reach"},
    {CascadeLoopStatus::not_found, "not found"}};

std::string to_string(CascadeLoopStatus status) {
  return internal::name_in(kCascadeLoopStatuses, status);
}

std::ostream& operator<<(std::ostream& out, const CascadeLoopDesign& design) {
  out << to_string(design.status);
  if (!design.solved()) return out << ": " << design.culprit;
  return out << ": " << design.gains << ", " << design.evidence.margins;
}

CascadeLoopDesign design_cascade_loop(const CascadePlant& plant, const CascadeLoopBounds& bounds,
                                      PidMethod method) {
  require_plant(plant);
  require_bounds(bounds, plant.dt);
  CascadeLoopDesign design;
  design.highest_rate_crossover =
      highest_rate_crossover(LoopResponses(plant, method, 0), bounds.Ms_max);
  const bool fixed = bounds.rate_crossover > 0;
  if (fixed && bounds.rate_crossover >= design.highest_rate_crossover) {
    design.status = CascadeLoopStatus::crossover_out_of_reach;
    design.culprit = fmt::format(
        "the rate's loop crosses 1 at {:.4g} rad/s, expected less than {:.4g} because there the "
        "hold, the lag and the delay take max |S| of the rate alone to {:.4g}",
        bounds.rate_crossover, design.highest_rate_crossover, bounds.Ms_max);
    return design;
  }
  const double reach = std::min(bounds.rate_crossover_max, design.highest_rate_crossover);
  const double fastest = fixed ? bounds.rate_crossover : reach;
  // Eighty times slower a value's part is looked for, and its integral is slower still.
  const LoopResponses responses(plant, method, 1e-4 * fastest);
  const auto Kd_for = [&](double w) { return 1 / std::abs(responses.at(w).rate); };
  Search search(responses, bounds);
  const double high_Kd = Kd_for(fastest);
  const Search::Point best =
      search.climb(search.scan(high_Kd, fixed, fastest), fixed, std::log(high_Kd));
  const double found = search.log_greatest(best);
  if (!(found > kLoadTooHigh)) {
    design.status = CascadeLoopStatus::not_found;
    design.culprit = "no gains were found that are stable with " + in_words(bounds);
    return design;
  }
  const PidGains gains = search.gains(best, found);
  const CascadeLoopEvidence evidence = evidence_of(plant, gains, method);
  if (!kept(bounds, evidence)) {
    design.status = CascadeLoopStatus::not_found;
    design.culprit = fmt::format(
        "what was found does not hold beyond the frequencies of the search: a loop that crosses 1 "
        "at {:.3g} rad/s is too slow for a period of {:.3g} s",
        fastest, plant.dt);
    return design;
  }
  design.status = CascadeLoopStatus::solved;
  design.gains = gains;
  design.evidence = evidence;
  const auto note = [&](double met, double bound, const char* name) {
    if (met > 0.999 * bound) design.binding.emplace_back(name);
  };
  note(design.evidence.margins.Ms, bounds.Ms_max, "Ms");
  note(design.evidence.tracking_peak, bounds.tracking_max, "tracking");
  note(design.evidence.load_peak, bounds.load_peak_max, "load peak");
  note(design.evidence.value_noise, bounds.value_noise_max, "value noise");
  note(design.evidence.rate_noise, bounds.rate_noise_max, "rate noise");
  if (!fixed) note(design.gains.Kd, high_Kd, "rate crossover");
  return design;
}

}  // namespace quadtune
