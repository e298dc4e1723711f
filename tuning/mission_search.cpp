// SPDX-License-Identifier: Apache-2.0
// Global: controlled random search with local mutation (Kaelo and Ali 2006), limits as a penalty,
// since it has none of its own. Local: COBYLA (Powell 1994), which keeps limits as such. Both of
// NLopt.
#include "quadtune/tuning/mission_search.hpp"

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Clock = std::chrono::steady_clock;

/// Cost of a limit that is passed by its whole size, against the start's cost of about 1.
constexpr double kPenalty = 20;
/// Of a point without a controller.
constexpr double kNoDesign = 2 * MissionTrial::kFailure;
/// How far within its limits a point is to stay, as a share: fresh draws are not those of the
/// search.
constexpr double kDistance = 0.01;
/// What nobody would change gains for [%].
constexpr double kLeastGain = 0.1;
/// Share of the time for the global part.
constexpr double kGlobalShare = 0.45;

struct Optimizer {
  explicit Optimizer(nlopt_algorithm algorithm, unsigned n)
      : handle(nlopt_create(algorithm, n), nlopt_destroy) {}
  std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> handle;
};

/// A point with what became of it.
struct Tried {
  Eigen::VectorXd x;
  DesignPoint design;
  TrialOutcome outcome;
  Eigen::VectorXd excess;  ///< of all limits, ≤ 0 where kept
  double cost = kNoDesign;

  [[nodiscard]] double penalized() const {
    return cost + kPenalty * (excess.array() + kDistance).cwiseMax(0).sum();
  }
  [[nodiscard]] double worst() const { return excess.size() > 0 ? excess.maxCoeff() : 0; }
};

class Search {
 public:
  Search(const DesignSpace& space, const MissionTrial& trial, const MissionSearchOptions& options)
      : space_(space), trial_(trial), options_(options), begin_(Clock::now()) {}

  MissionSearchResult run() {
    start_ = tried(space_.start);
    if (!start_.design.controller)
      throw InvalidInput("search",
                         "the design that it begins with has no solution or is not "
                         "stable");
    // A limit that the start passes already is one to come nearer to, not one that ends the search.
    slack_ = start_.excess.cwiseMax(-kDistance);
    best_ = start_;
    go(NLOPT_GN_CRS2_LM, kGlobalShare);
    // Twice, since its first steps are wide.
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

  Tried tried(const Eigen::VectorXd& x) {
    ++evaluations_;
    Tried point;
    point.x = x;
    point.design = space_.point(x);
    const Eigen::Index limits = start_.excess.size();
    if (!point.design.controller) {
      point.excess = Eigen::VectorXd::Ones(limits);
      return point;
    }
    point.outcome = trial_.fly(*point.design.controller);
    point.cost = point.outcome.cost;
    std::vector<double> excess;
    for (const DesignLimit& limit : point.design.limits) excess.push_back(limit.excess());
    for (const TrialLimit& limit : point.outcome.limits) excess.push_back(limit.excess());
    point.excess = Eigen::Map<Eigen::VectorXd>(excess.data(), std::ssize(excess));
    return point;
  }

  /// Whether a point keeps all limits, or passes none farther than the start does.
  [[nodiscard]] bool allowed(const Tried& point) const {
    return (point.excess - slack_).maxCoeff() <= 1e-9 || point.excess.size() == 0;
  }
  [[nodiscard]] bool better(const Tried& a, const Tried& b) const {
    if (allowed(a) != allowed(b)) return allowed(a);
    return a.penalized() < b.penalized();
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
    if (options_.progress)
      options_.progress(best_.cost, evaluations_, std::max(options_.seconds - seconds(), 0.0));
    return now_;
  }

  static Eigen::VectorXd vector(unsigned n, const double* x) {
    return Eigen::Map<const Eigen::VectorXd>(x, n);
  }
  static double penalized(unsigned n, const double* x, double*, void* search) {
    return static_cast<Search*>(search)->at(vector(n, x)).penalized();
  }
  static double cost(unsigned n, const double* x, double*, void* search) {
    return static_cast<Search*>(search)->at(vector(n, x)).cost;
  }
  static void excesses(unsigned m, double* result, unsigned n, const double* x, double*,
                       void* search) {
    auto& self = *static_cast<Search*>(search);
    const Tried& point = self.at(vector(n, x));
    for (unsigned i = 0; i < m; ++i)
      result[i] =
          point.excess(static_cast<Eigen::Index>(i)) - self.slack_(static_cast<Eigen::Index>(i));
  }

  /// One algorithm from the best point, until a share of time or evaluations is spent.
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
      nlopt_set_min_objective(opt, cost, this);
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
    result.before = start_.outcome;
    result.best = space_.start;
    result.design = start_.design;
    result.after = start_.outcome;
    if (end_ != SearchEnd::interrupted && converged_) end_ = SearchEnd::converged;
    result.end = end_;
    if (best_.x == start_.x) {
      result.reason = "no point that keeps the limits costs less than the start";
      result.seconds = seconds();
      return result;
    }
    // Draws that the search has not seen: it may have found what is good for its own alone.
    const std::uint32_t first = trial_.request().draws, count = options_.proof_draws;
    result.proof_before = trial_.fly(*start_.design.controller, first, count);
    result.proof_after = trial_.fly(*best_.design.controller, first, count);
    result.difference = paired_difference(result.proof_before.costs, result.proof_after.costs);
    result.seconds = seconds();
    if (!(percent(result, result.difference.high) > kLeastGain)) {
      result.reason = fmt::format(
          "on {} fresh draws the best point costs {:+.3g} ({:+.3g} to {:+.3g}) more than the "
          "start: not surely {} % less",
          count, result.difference.value, result.difference.low, result.difference.high,
          kLeastGain);
      return result;
    }
    for (std::size_t i = 0; i < result.proof_after.limits.size(); ++i) {
      const TrialLimit& now = result.proof_after.limits[i];
      const TrialLimit& then = result.proof_before.limits[i];
      if (now.excess() > std::max(then.excess(), 0.0) + 1e-9) {
        result.reason = fmt::format(
            "on {} fresh draws it passes {} of {}: {:.4g}, expected at "
            "most {:.4g}",
            count, name_of(now.metric), now.mission, now.value, now.most);
        return result;
      }
    }
    if (result.proof_after.failed > result.proof_before.failed) {
      result.reason = fmt::format("{} of {} fresh flights end early, with the start {}",
                                  result.proof_after.failed, result.proof_after.flights,
                                  result.proof_before.failed);
      return result;
    }
    result.accepted = true;
    result.reason = fmt::format("on {} fresh draws it costs {:.1f} % less ({:.1f} to {:.1f} %)",
                                count, percent(result, result.difference.value),
                                percent(result, result.difference.high),
                                percent(result, result.difference.low));
    result.best = best_.x;
    result.design = best_.design;
    result.after = best_.outcome;
    for (const DesignLimit& limit : result.design.limits)
      if (std::abs(limit.excess()) <= 0.02) result.binding.push_back(limit.name);
    for (const TrialLimit& limit : result.after.limits)
      if (std::abs(limit.excess()) <= 0.02)
        result.binding.push_back(fmt::format("{} of {}", name_of(limit.metric), limit.mission));
    return result;
  }

  /// A fall of the cost as a share of the start's.
  static double percent(const MissionSearchResult& result, double difference) {
    double before = 0;
    for (const double cost : result.proof_before.costs)
      before += cost / static_cast<double>(result.proof_before.costs.size());
    return -100 * difference / before;
  }

  const DesignSpace& space_;
  const MissionTrial& trial_;
  const MissionSearchOptions& options_;
  Clock::time_point begin_;
  Tried start_, best_, now_;
  Eigen::VectorXd slack_;
  int evaluations_ = 0;
  bool converged_ = false;
  SearchEnd end_ = SearchEnd::budget;
  nlopt_opt current_ = nullptr;
};

}  // namespace

double DesignLimit::excess() const {
  if (!std::isfinite(value)) return at_least && value > 0 ? -1 : 1;
  const double size = std::max(std::abs(bound), 1e-12);
  return std::clamp((at_least ? bound - value : value - bound) / size, -1.0, 1.0);
}

std::string to_string(SearchEnd end) {
  switch (end) {
    case SearchEnd::budget:
      return "budget";
    case SearchEnd::converged:
      return "converged";
    case SearchEnd::interrupted:
      break;
  }
  return "interrupted";
}

MissionSearchResult search_missions(const DesignSpace& space, const MissionTrial& trial,
                                    const MissionSearchOptions& options) {
  if (!(options.seconds > 0) || options.evaluations < 1 || options.proof_draws < 2 ||
      !(space.reach > 0) || space.start.size() == 0 ||
      space.start.size() != std::ssize(space.names))
    throw InvalidInput("search", "seconds, evaluations, proof draws or the space are out of range");
  return Search(space, trial, options).run();
}

}  // namespace quadtune
