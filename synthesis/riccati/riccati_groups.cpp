// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstdint>
#include <vector>

#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {
namespace {

/// Sets of states or inputs.
using Set = std::uint64_t;
constexpr Eigen::Index kMaxMembers = 64;

Set only(Eigen::Index i) { return Set{1} << i; }

/// States and inputs that are decoupled from all others.
struct Members {
  Set states = 0;
  Set inputs = 0;
};

/// A group as a separate problem, with the memory to solve it.
class Group {
 public:
  bool solve(const RiccatiEquation& whole, const Eigen::MatrixXd& factor_R, const Members& members,
             const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) {
    fill(whole, factor_R, members);
    const ConstRef A(A_), B(B_), Q(Q_), R(R_), N(N_);
    const RiccatiEquation problem{whole.time, A, B, Q, R, N};
    if (!solver_->solve(problem, factor_R_, options, found_, norms)) return false;
    found.iterations = std::max(found.iterations, found_.iterations);
    for (std::size_t j = 0; j < states_.size(); ++j) {
      for (std::size_t i = 0; i < states_.size(); ++i)
        found.X(states_[i], states_[j]) = found_.X(row(i), row(j));
      for (std::size_t i = 0; i < inputs_.size(); ++i)
        found.K(inputs_[i], states_[j]) = found_.K(row(i), row(j));
    }
    return true;
  }

 private:
  static Eigen::Index row(std::size_t i) { return static_cast<Eigen::Index>(i); }

  static void list(Set set, std::vector<Eigen::Index>& members) {
    members.clear();
    for (; set != 0; set &= set - 1) members.push_back(std::countr_zero(set));
  }

  static void pick(const ConstRef& from, const std::vector<Eigen::Index>& rows,
                   const std::vector<Eigen::Index>& cols, Eigen::MatrixXd& to) {
    for (std::size_t j = 0; j < cols.size(); ++j)
      for (std::size_t i = 0; i < rows.size(); ++i) to(row(i), row(j)) = from(rows[i], cols[j]);
  }

  /// Copies the problem of a group. States without inputs get one input that has no effect.
  void fill(const RiccatiEquation& whole, const Eigen::MatrixXd& factor_R, const Members& members) {
    states_.reserve(kMaxMembers);
    inputs_.reserve(kMaxMembers);
    list(members.states, states_);
    list(members.inputs, inputs_);
    const auto nx = row(states_.size());
    const auto nu = std::max<Eigen::Index>(row(inputs_.size()), 1);
    if (!solver_ || A_.rows() != nx || R_.rows() != nu) {
      solver_ = make_dense_solver(nx, nu);
      A_.resize(nx, nx);
      B_.resize(nx, nu);
      Q_.resize(nx, nx);
      R_.resize(nu, nu);
      factor_R_.resize(nu, nu);
    }
    N_.resize(whole.has_cross_term() ? nx : 0, whole.has_cross_term() ? nu : 0);
    if (inputs_.empty()) {
      B_.setZero();
      R_.setOnes();
      factor_R_.setOnes();
      N_.setZero();
    }
    pick(whole.A, states_, states_, A_);
    pick(whole.B, states_, inputs_, B_);
    pick(whole.Q, states_, states_, Q_);
    pick(whole.R, inputs_, inputs_, R_);
    pick(factor_R, inputs_, inputs_, factor_R_);
    if (whole.has_cross_term()) pick(whole.N, states_, inputs_, N_);
  }

  std::vector<Eigen::Index> states_;
  std::vector<Eigen::Index> inputs_;
  Eigen::MatrixXd A_, B_, Q_, R_, N_, factor_R_;
  Candidate found_;
  std::unique_ptr<DoublingSolver> solver_;
};

class GroupedSolver final : public DoublingSolver {
 public:
  GroupedSolver(Eigen::Index nx, Eigen::Index nu)
      : nx_(nx),
        nu_(nu),
        neighbours_(static_cast<std::size_t>(nx)),
        inputs_of_(static_cast<std::size_t>(nx)),
        whole_(make_dense_solver(nx, nu)) {
    members_.reserve(static_cast<std::size_t>(nx));
  }

  bool solve(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R,
             const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) override {
    if (nx_ == 1 || nx_ > kMaxMembers || nu_ > kMaxMembers || !falls_apart(problem))
      return whole_->solve(problem, factor_R, options, found, norms);
    norms = {};
    found.iterations = 0;
    found.X.setZero(nx_, nx_);
    found.K.setZero(nu_, nx_);  // the gain of an input without states is 0
    if (groups_.size() < members_.size()) groups_.resize(members_.size());
    for (std::size_t g = 0; g < members_.size(); ++g) {
      SquaredNorms part;
      if (!groups_[g].solve(problem, factor_R, members_[g], options, found, part)) return false;
      norms += part;
    }
    return true;
  }

 private:
  /// Computes members_. False if all states are in one group.
  bool falls_apart(const RiccatiEquation& p) {
    for (Eigen::Index j = 0; j < nx_; ++j) neighbours_[at(j)] = only(j);
    for (Eigen::Index j = 0; j < nx_; ++j)
      for (Eigen::Index i = 0; i < nx_; ++i)
        if (p.A(i, j) != 0 || p.Q(i, j) != 0) {
          neighbours_[at(i)] |= only(j);
          neighbours_[at(j)] |= only(i);
        }
    for (Eigen::Index i = 0; i < nx_; ++i) inputs_of_[at(i)] = 0;
    for (Eigen::Index k = 0; k < nu_; ++k) {
      Set users = 0;
      for (Eigen::Index i = 0; i < nx_; ++i)
        for (Eigen::Index l = 0; l < nu_; ++l)  // also inputs with a joint weight with k
          if (l == k || p.R(l, k) != 0)
            if (p.B(i, l) != 0 || (p.has_cross_term() && p.N(i, l) != 0)) users |= only(i);
      for (Set rest = users; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        neighbours_[i] |= users;
        inputs_of_[i] |= only(k);
      }
    }
    members_.clear();
    const Set all = nx_ == kMaxMembers ? ~Set{0} : only(nx_) - 1;
    for (Set rest = all; rest != 0; rest &= ~members_.back().states)
      members_.push_back(connected(static_cast<std::size_t>(std::countr_zero(rest))));
    return members_.size() > 1;
  }

  Members connected(std::size_t first) const {
    Members group;
    for (Set next = Set{1} << first; next != 0; next &= ~group.states) {
      const auto i = static_cast<std::size_t>(std::countr_zero(next));
      group.states |= Set{1} << i;
      group.inputs |= inputs_of_[i];
      next |= neighbours_[i];
    }
    return group;
  }

  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

  Eigen::Index nx_;
  Eigen::Index nu_;
  std::vector<Set> neighbours_;
  std::vector<Set> inputs_of_;
  std::vector<Members> members_;
  std::vector<Group> groups_;
  std::unique_ptr<DoublingSolver> whole_;
};

}  // namespace

std::unique_ptr<DoublingSolver> make_doubling_solver(Eigen::Index nx, Eigen::Index nu) {
  return std::make_unique<GroupedSolver>(nx, nu);
}

}  // namespace quadtune::internal
