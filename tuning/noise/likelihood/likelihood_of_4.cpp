// SPDX-License-Identifier: Apache-2.0
#include "noise/likelihood/likelihood_evaluator_making.hpp"

namespace quadtune::internal {

template std::unique_ptr<LikelihoodEvaluator> make_evaluator<4>(const PreparedModel&, int);

}  // namespace quadtune::internal
