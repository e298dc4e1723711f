// SPDX-License-Identifier: Apache-2.0
#include "noise/dense/dense_likelihood_making.hpp"

namespace quadtune::internal {

template std::unique_ptr<DenseLikelihood> make_dense_likelihood_of<8>(const PreparedModel&);

}  // namespace quadtune::internal
