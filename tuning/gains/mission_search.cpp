// SPDX-License-Identifier: Apache-2.0
// Global: controlled random search with local mutation (Kaelo and Ali 2006). It has no constraints,
// so limits are a penalty. Local: COBYLA (Powell 1994), with the limits as constraints. Both are
// from NLopt.
#include "quadtune/tuning/mission_search.hpp"

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {
namespace {

using Clock = std::chrono::steady_clock;

/// Cost of a limit that is exceeded by 100 %, compared with a cost of the start of about 1.
constexpr double kPenalty = 20;
/// Cost of a point without a controller.
constexpr double kNoDesign = 2 * MissionTrial::kFailure;
/// Distance that the search keeps from a limit, as a share, because fresh draws differ from those
/// of the search.
constexpr double kDistance = 0.01;
/// Minimum distance between a bound and the smallest possible value.
constexpr double kMinRoom = 0.01;
/// Smallest cost reduction that justifies a change of gains [%].
constexpr double kMinGain = 0.1;
/// A limit is active if the point is closer than this to the largest allowed excess, as a share.
constexpr double kEdge = 0.005;
/// Draws of the proof after an interrupt, few so that it ends soon.
constexpr std::uint32_t kHurriedProof = 100;
/// Share of the time limit for the global search.
constexpr double kGlobalShare = 0.45;

struct Optimizer {
  explicit Optimizer(nlopt_algorithm algorithm, unsigned n)
      : handle(nlopt_create(algorithm, n), nlopt_destroy) {}
  std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> handle;
};

/// A point with the outcome of its flights.
struct Tried {
  Eigen::VectorXd x;
  DesignPoint design;
  TrialOutcome outcome;
  Eigen::VectorXd excess;  ///< of all limits, ≤ 0 if satisfied
  double cost = kNoDesign;
};

/// Minimize slopeᵀd subject to slopes · d ≤ room and |d| ≤ reach.
struct LinearProgram {
  Eigen::VectorXd slope;   ///< (n)
  Eigen::MatrixXd slopes;  ///< (m × n)
  Eigen::VectorXd room;    ///< (m) ≥ 0, so that d = 0 is allowed
  double reach = 0;
};

/// The solution d of a program; 0 if no better one is found.
Eigen::VectorXd solution(const LinearProgram& program) {
  const double size = program.slope.norm();
  Eigen::VectorXd none = Eigen::VectorXd::Zero(program.slope.size());
  if (!(size > 0)) return none;
  const auto n = static_cast<unsigned>(program.slope.size());
  const Optimizer optimizer(NLOPT_LD_SLSQP, n);
  nlopt_opt opt = optimizer.handle.get();
  nlopt_set_lower_bounds1(opt, -program.reach);
  nlopt_set_upper_bounds1(opt, program.reach);
  // Scaled so that the first quadratic model extends from bound to bound.
  const Eigen::VectorXd direction = program.slope / size;
  const auto value = [](unsigned count, const double* x, double* gradient, void* data) {
    const auto& along = *static_cast<const Eigen::VectorXd*>(data);
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, count) = along;
    return along.dot(Eigen::Map<const Eigen::VectorXd>(x, count));
  };
  nlopt_set_min_objective(opt, value, const_cast<Eigen::VectorXd*>(&direction));
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto limits = [](unsigned count, double* result, unsigned variables, const double* x,
                         double* gradient, void* data) {
    const auto& of = *static_cast<const LinearProgram*>(data);
    Eigen::Map<Eigen::VectorXd>(result, count) =
        of.slopes * Eigen::Map<const Eigen::VectorXd>(x, variables) - of.room;
    if (gradient != nullptr) Eigen::Map<Rows>(gradient, count, variables) = of.slopes;
  };
  const Eigen::VectorXd tolerance = Eigen::VectorXd::Constant(program.room.size(), 1e-9);
  if (program.room.size() > 0)
    nlopt_add_inequality_mconstraint(opt, static_cast<unsigned>(program.room.size()), limits,
                                     const_cast<LinearProgram*>(&program), tolerance.data());
  nlopt_set_xtol_abs1(opt, 1e-9);
  nlopt_set_maxeval(opt, 500);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(program.slope.size());
  double found = 0;
  nlopt_optimize(opt, x.data(), &found);
  const bool kept = x.allFinite() && (program.room.size() == 0 ||
                                      (program.slopes * x - program.room).maxCoeff() < 1e-6);
  return kept ? x : none;
}

class Search {
 public:
  Search(const DesignSpace& space, const MissionTrial& trial, const MissionSearchOptions& options)
      : space_(space), trial_(trial), options_(options), begin_(Clock::now()) {}

  MissionSearchResult run() {
    start_ = tried(space_.start);
    if (!start_.design.controller)
      throw InvalidInput("search",
                         "the design at the start has no solution or is not "
                         "stable");
    // A limit that the start exceeds is to be approached and does not end the search; a point may
    // stay at a limit at which the start is.
    slack_ = start_.excess.cwiseMax(-kDistance);
    target_ = (slack_.array() > kLimitTolerance).select(-kDistance, slack_);
    best_ = now_ = start_;
    told();
    go(NLOPT_GN_CRS2_LM, kGlobalShare);
    // Run it twice, since its first steps are large.
    for (const double until : {0.75, 1.0}) go(NLOPT_LN_COBYLA, until);
    return judged();
  }

 private:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }
  bool over() {
    if (options_.stop && options_.stop()) end_ = SearchEnd::interrupted;
    return end_ == SearchEnd::interrupted || seconds() >= options_.seconds ||
           evaluations_ >= options_.evaluations;
  }

  [[nodiscard]] bool of_quantile() const {
    return trial_.request().measure == RobustMeasure::quantile;
  }

  /// The quantity of the best point that is compared with the start.
  [[nodiscard]] std::string compared() const {
    return of_quantile() ? fmt::format("the {:g} quantile of its cost is", trial_.request().share)
                         : "it costs";
  }

  Tried tried(const Eigen::VectorXd& x) {
    ++evaluations_;
    Tried point;
    point.x = x;
    point.design = space_.point(x);
    const Eigen::Index limits = start_.excess.size();
    if (!point.design.controller) {
      point.excess =
          Eigen::VectorXd::Constant(limits, excess_of(std::numeric_limits<double>::infinity()));
      return point;
    }
    point.outcome = trial_.fly(*point.design.controller, options_.stop);
    point.cost = point.outcome.cost;
    std::vector<double> excess;
    excess.reserve(point.design.limits.size());
    for (const DesignLimit& limit : point.design.limits) excess.push_back(limit.excess());
    for (const TrialLimit& limit : point.outcome.limits) excess.push_back(limit.excess());
    point.excess = Eigen::Map<Eigen::VectorXd>(excess.data(), std::ssize(excess));
    return point;
  }

  /// Whether a point satisfies all limits, or exceeds none by more than the start does.
  [[nodiscard]] bool allowed(const Tried& point) const {
    return (point.excess - slack_).maxCoeff() <= kLimitTolerance || point.excess.size() == 0;
  }
  [[nodiscard]] bool better(const Tried& a, const Tried& b) const {
    if (allowed(a) != allowed(b)) return allowed(a);
    return penalized(a) < penalized(b);
  }
  /// The cost plus the penalty of exceeded limits.
  [[nodiscard]] double penalized(const Tried& point) const {
    return point.cost + kPenalty * (point.excess - target_).cwiseMax(0).sum();
  }
  /// The same with the penalty of only those limits that the start exceeds: the others are
  /// constraints.
  [[nodiscard]] double constrained(const Tried& point) const {
    return point.cost + kPenalty * (slack_.array() > kLimitTolerance)
                                       .select(point.excess - target_, 0.0)
                                       .cwiseMax(0)
                                       .sum();
  }

  const Tried& at(const Eigen::VectorXd& x) {
    if (now_.x.size() == x.size() && now_.x == x) return now_;
    if (over()) {
      if (current_) nlopt_force_stop(current_);
      return now_.x.size() ? now_ : start_;
    }
    try {
      now_ = tried(x);
    } catch (const Interrupted&) {
      end_ = SearchEnd::interrupted;
      if (current_) nlopt_force_stop(current_);
      return now_.x.size() ? now_ : start_;
    }
    if (better(now_, best_)) best_ = now_;
    told();
    return now_;
  }

  /// Records the point `now_` and reports the progress.
  void told() {
    steps_.push_back(
        {now_.design.controller ? now_.cost : std::nan(""), allowed(now_), best_.cost});
    if (!options_.progress) return;
    const double spent = seconds();
    const double rest = spent / evaluations_ * (options_.evaluations - evaluations_);
    options_.progress(best_.cost, evaluations_,
                      std::max(std::min(options_.seconds - spent, rest), 0.0));
  }

  static Eigen::VectorXd vector(unsigned n, const double* x) {
    return Eigen::Map<const Eigen::VectorXd>(x, n);
  }
  static double penalized(unsigned n, const double* x, double*, void* search) {
    auto& self = *static_cast<Search*>(search);
    return self.penalized(self.at(vector(n, x)));
  }
  static double constrained(unsigned n, const double* x, double*, void* search) {
    auto& self = *static_cast<Search*>(search);
    return self.constrained(self.at(vector(n, x)));
  }
  static void excesses(unsigned m, double* result, unsigned n, const double* x, double*,
                       void* search) {
    auto& self = *static_cast<Search*>(search);
    const Tried& point = self.at(vector(n, x));
    for (unsigned i = 0; i < m; ++i)
      result[i] =
          point.excess(static_cast<Eigen::Index>(i)) - self.slack_(static_cast<Eigen::Index>(i));
  }

  /// Runs one algorithm from the best point, until a share of time or evaluations is spent.
  void go(nlopt_algorithm algorithm, double share) {
    const double left = share * options_.seconds - seconds();
    const auto points = static_cast<int>(share * options_.evaluations) - evaluations_;
    if (over() || !(left > 0) || points <= 0) return;
    const auto n = static_cast<unsigned>(space_.start.size());
    const Optimizer optimizer(algorithm, n);
    nlopt_opt opt = optimizer.handle.get();
    const Eigen::VectorXd low = space_.start.array() - space_.reach;
    const Eigen::VectorXd high = space_.start.array() + space_.reach;
    nlopt_set_lower_bounds(opt, low.data());
    nlopt_set_upper_bounds(opt, high.data());
    nlopt_set_maxtime(opt, left);
    nlopt_set_maxeval(opt, points);
    const bool local = algorithm == NLOPT_LN_COBYLA;
    if (local) {
      nlopt_set_min_objective(opt, constrained, this);
      if (slack_.size() > 0) {
        const Eigen::VectorXd tolerance = Eigen::VectorXd::Constant(slack_.size(), 1e-6);
        nlopt_add_inequality_mconstraint(opt, static_cast<unsigned>(slack_.size()), excesses, this,
                                         tolerance.data());
      }
      nlopt_set_initial_step1(opt, 0.15);
      nlopt_set_xtol_abs1(opt, 1e-3);
    } else {
      nlopt_srand(trial_.request().seed);
      nlopt_set_min_objective(opt, penalized, this);
      nlopt_set_population(opt, 4 * (n + 1));
    }
    now_ = best_;
    Eigen::VectorXd x = best_.x;
    double value = 0;
    current_ = opt;
    const nlopt_result result = nlopt_optimize(opt, x.data(), &value);
    current_ = nullptr;
    converged_ = local && result == NLOPT_XTOL_REACHED;
  }

  MissionSearchResult judged() {
    MissionSearchResult result;
    result.evaluations = evaluations_;
    result.steps = std::move(steps_);
    result.before = start_.outcome;
    result.after = best_.outcome;
    result.best = space_.start;
    result.candidate = best_.x;
    if (end_ != SearchEnd::interrupted && converged_) end_ = SearchEnd::converged;
    for (const auto& [name, i] : names(best_))
      if (best_.x != start_.x && best_.excess(i) <= kLimitTolerance &&
          best_.excess(i) >= target_(i) - kEdge)
        result.binding.push_back(name);
    try {
      if (!result.binding.empty() && end_ != SearchEnd::interrupted) price(result);
      prove(result);
    } catch (const Interrupted&) {
      end_ = SearchEnd::interrupted;
      result.proof_before = result.proof_after = {};
      result.reason = "interrupted before the proof of the best point was complete";
    }
    if (result.accepted) result.best = best_.x;
    const Tried& taken = result.accepted ? best_ : start_;
    const TrialOutcome& flown = result.accepted ? result.proof_after : result.proof_before;
    const auto design_limits = std::ssize(taken.design.limits);
    for (const auto& [name, i] : names(taken)) {
      const bool proved = i >= design_limits && !flown.limits.empty();
      const double excess = proved
                                ? flown.limits[static_cast<std::size_t>(i - design_limits)].excess()
                                : taken.excess(i);
      if (excess > kLimitTolerance) result.broken.push_back(name);
    }
    result.end = end_;
    result.seconds = seconds();
    return result;
  }

  /// The limits of a point by name, with their indices.
  static std::vector<std::pair<std::string, Eigen::Index>> names(const Tried& point) {
    std::vector<std::pair<std::string, Eigen::Index>> all;
    for (const DesignLimit& limit : point.design.limits)
      all.emplace_back(limit.name, std::ssize(all));
    for (const TrialLimit& limit : point.outcome.limits)
      all.emplace_back(fmt::format("{} of {}", name_of(limit.metric), limit.mission),
                       std::ssize(all));
    return all;
  }

  /// Computes the cost reduction that looser limits allow: the slopes of cost and limits at the
  /// best point determine the optimum with the limit as it is and with a looser one, and both
  /// points are flown.
  void price(MissionSearchResult& result) {
    constexpr double kStep = 0.02, kReach = 0.1;
    const Eigen::Index n = best_.x.size(), m = best_.excess.size();
    // As in the search: a limit that the start exceeds is penalized from its target on.
    const Eigen::VectorXd max =
        (slack_.array() > kLimitTolerance).select(target_, slack_).cwiseMax(best_.excess);
    LinearProgram program{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(m, n), max - best_.excess,
                          kReach};
    for (Eigen::Index j = 0; j < n; ++j)
      for (const double step : {kStep, -kStep}) {
        Eigen::VectorXd x = best_.x;
        x(j) += step;
        const Tried beside = tried(x);
        if (!beside.design.controller) continue;
        program.slope(j) = (beside.cost - best_.cost) / step;
        program.slopes.col(j) = (beside.excess - best_.excess) / step;
        break;
      }
    const double kept = flown_cost(program, max, best_.cost);
    std::vector<double> buys;
    for (const std::string& binding : result.binding) {
      LinearProgram loosened = program;
      Eigen::VectorXd looser = max;
      for (const auto& [name, i] : names(best_))
        if (name == binding) {
          loosened.room(i) += kLoosened;
          looser(i) += kLoosened;
        }
      buys.push_back(100 * std::max(kept - flown_cost(loosened, looser, kept), 0.0) / best_.cost);
    }
    result.buys = buys;
  }

  /// The cost at the solution of a program, or at half or a quarter of the step to it: the first of
  /// these that satisfies the limits. At most `usual`.
  double flown_cost(const LinearProgram& program, const Eigen::VectorXd& max, double usual) {
    const Eigen::VectorXd change = solution(program);
    for (const double share : {1.0, 0.5, 0.25}) {
      const Tried point = tried(best_.x + share * change);
      if (!point.design.controller) continue;
      if (max.size() == 0 || (point.excess - max).maxCoeff() <= kEdge)
        return std::min(point.cost, usual);
    }
    return usual;
  }

  /// Flies the start and the best point on draws that the search has not used, since the search may
  /// have fitted its own draws.
  void prove(MissionSearchResult& result) {
    const bool hurried = end_ == SearchEnd::interrupted;
    const std::uint32_t first = trial_.request().draws;
    const std::uint32_t max = std::max(kHurriedProof, min_draws(trial_.request()));
    const std::uint32_t count =
        hurried ? std::min(options_.proof_draws, max) : options_.proof_draws;
    const auto fresh = [&](const Tried& point) {
      return trial_.fly(*point.design.controller, first, count,
                        hurried ? MissionTrial::Stop{} : options_.stop);
    };
    const bool same = best_.x == start_.x;
    const TrialOutcome then = fresh(start_), now = same ? then : fresh(best_);
    result.proof_before = then;
    result.proof_after = now;
    double whole = then.cost;
    if (of_quantile()) {
      result.difference = paired_quantile_difference(then.costs, now.costs, trial_.request().share);
    } else {
      result.difference = paired_difference(then.costs, now.costs);
      whole = std::accumulate(then.costs.begin(), then.costs.end(), 0.0) / count;
    }
    result.less = -100 * result.difference.value / whole;
    result.less_low = -100 * result.difference.high / whole;
    result.less_high = -100 * result.difference.low / whole;
    result.reason = same ? "no point that satisfies the limits costs less than the start"
                         : refused(result, count);
    if (!result.reason.empty()) return;
    result.accepted = true;
    const std::string cost =
        fmt::format("on {} fresh draws {} {:.1f} % {} ({:.1f} to {:.1f} %)", count, compared(),
                    std::abs(result.less), result.less < 0 ? "more" : "less",
                    result.less < 0 ? -result.less_high : result.less_low,
                    result.less < 0 ? -result.less_low : result.less_high);
    result.repaired = repaired(result);
    result.reason =
        result.repaired ? "it satisfies all limits, and the start does not; " + cost : cost;
  }

  /// Whether the best point satisfies all limits on fresh draws and the start does not.
  [[nodiscard]] bool repaired(const MissionSearchResult& result) const {
    const auto keeps = [](const Tried& point, const TrialOutcome& proof) {
      return proof.satisfies_limits() &&
             std::all_of(
                 point.design.limits.begin(), point.design.limits.end(),
                 [](const DesignLimit& limit) { return limit.excess() <= kLimitTolerance; });
    };
    return keeps(best_, result.proof_after) && !keeps(start_, result.proof_before);
  }

  /// Why the best point is rejected on the fresh draws; empty if it is not.
  [[nodiscard]] std::string refused(const MissionSearchResult& result, std::uint32_t count) const {
    const TrialOutcome &then = result.proof_before, &now = result.proof_after;
    for (std::size_t i = 0; i < now.limits.size(); ++i)
      if (now.limits[i].excess() > std::max(then.limits[i].excess(), 0.0) + kLimitTolerance)
        return fmt::format(
            "on {} fresh draws the result exceeds {} of {}: {:.4g}, expected at most {:.4g}", count,
            name_of(now.limits[i].metric), now.limits[i].mission, now.limits[i].value,
            std::max(now.limits[i].max, then.limits[i].value));
    if (now.failed > then.failed)
      return fmt::format("{} of {} fresh flights end early, compared with {} for the start",
                         now.failed, now.flights, then.failed);
    if (repaired(result)) return {};
    if (!(result.less_low > kMinGain))
      return fmt::format(
          "on {} fresh draws the {} of the result is {:.3g} % below that of the start ({:.3g} to "
          "{:.3g} %; negative: above), which is not significantly more than {} %",
          count, of_quantile() ? "quantile of the cost" : "cost", result.less, result.less_low,
          result.less_high, kMinGain);
    // The mean is significantly lower, but the worst case, if that is the measure, may not be.
    if (now.cost > then.cost)
      return fmt::format("on {} fresh draws the {} of its cost is {:.4g}, that of the start {:.4g}",
                         count, to_string(trial_.request().measure), now.cost, then.cost);
    return {};
  }

  const DesignSpace& space_;
  const MissionTrial& trial_;
  const MissionSearchOptions& options_;
  Clock::time_point begin_;
  Tried start_, best_, now_;
  Eigen::VectorXd slack_;   ///< largest allowed excess of each limit
  Eigen::VectorXd target_;  ///< excess from which it is penalized
  std::vector<SearchStep> steps_;
  int evaluations_ = 0;
  bool converged_ = false;
  SearchEnd end_ = SearchEnd::budget;
  nlopt_opt current_ = nullptr;
};

}  // namespace

double DesignLimit::excess() const {
  if (at_least && value == std::numeric_limits<double>::infinity()) return -1;
  const double size = std::max(std::abs(bound - min), kMinRoom);
  return excess_of((at_least ? bound - value : value - bound) / size);
}

constexpr internal::EnumName<SearchEnd> kSearchEnds[] = {{SearchEnd::budget, "budget"},
                                                         {SearchEnd::converged, "converged"},
                                                         {SearchEnd::interrupted, "interrupted"}};

std::string to_string(SearchEnd end) { return internal::name_in(kSearchEnds, end); }

MissionSearchResult search_missions(const DesignSpace& space, const MissionTrial& trial,
                                    const MissionSearchOptions& options) {
  if (!(options.seconds > 0) || options.evaluations < 1 || options.proof_draws < 2 ||
      !(space.reach > 0) || space.start.size() == 0 ||
      space.start.size() != std::ssize(space.names))
    throw InvalidInput("search", "seconds, evaluations, proof draws or the space are out of range");
  if (const std::uint32_t min = min_draws(trial.request()); options.proof_draws < min)
    throw InvalidInput("search", fmt::format("{} fresh draws are too few for the {:g} quantile, "
                                             "expected at least {}",
                                             options.proof_draws, trial.request().share, min));
  return Search(space, trial, options).run();
}

}  // namespace quadtune
