// SPDX-License-Identifier: Apache-2.0
#include "noise/likelihood/likelihood_engine_of.hpp"

namespace quadtune::internal {

template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<2>(const PreparedModel&);
template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<4>(const PreparedModel&);
template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<8>(const PreparedModel&);

}  // namespace quadtune::internal
