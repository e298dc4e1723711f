// SPDX-License-Identifier: Apache-2.0
/// Results of a forward pass that the adjoint pass reads.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "noise/likelihood/engine_model.hpp"
#include "noise/likelihood/steady_state.hpp"

namespace quadtune::internal {

/// A stretch of a record that the adjoint pass processes at once.
template <int N>
struct TapePiece {
  Eigen::Index begin = 0, end = 0;
  int steady = -1;          ///< index of its gains; -1: they change
  FilterState<N> start;     ///< before `begin`
  Eigen::VectorXd numbers;  ///< empty: they did not fit, so the stretch is filtered again
};

/// Results of a forward pass that the adjoint pass reads; reused by the next evaluation to avoid
/// allocations.
template <int N>
class Tape {
 public:
  static constexpr Eigen::Index kPieceSamples = 1024;
  static constexpr Eigen::Index kEntry = N + 2;  ///< numbers of one measurement: K, 1/S, e/S

  /// Steady samples take a tenth of the time of others, so that passes call `stop` less often:
  /// never in a short record.
  static constexpr int kSteadyPiecesPerQuestion = 8;

  std::vector<TapePiece<N>> pieces;  ///< of which the first `count` are in use
  std::size_t count = 0;
  std::vector<SteadyState<N>> steady;

  void clear() {
    count = 0;
    steady.clear();
    left_ = kMaxNumbers;
    steady_left_ = kMaxSteadyNumbers;
  }
  TapePiece<N>& add(Eigen::Index begin, Eigen::Index size, int steady_index,
                    const FilterState<N>& start) {
    if (count == pieces.size()) pieces.emplace_back();
    TapePiece<N>& piece = pieces[count++];
    piece.begin = begin;
    piece.steady = steady_index;
    piece.start = start;
    Eigen::Index& left = steady_index < 0 ? left_ : steady_left_;
    piece.numbers.resize(size <= left ? size : 0);
    left -= piece.numbers.size();
    return piece;
  }

 private:
  /// 64 MiB, and 4 MiB of steady gains, whose filter is fast: the memory of a fit must not grow
  /// with the log.
  static constexpr Eigen::Index kMaxNumbers = Eigen::Index{1} << 23;
  static constexpr Eigen::Index kMaxSteadyNumbers = Eigen::Index{1} << 19;
  Eigen::Index left_ = 0, steady_left_ = 0;
};

}  // namespace quadtune::internal
