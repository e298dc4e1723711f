// SPDX-License-Identifier: Apache-2.0
#include "noise/likelihood/likelihood_engine_of.hpp"

namespace quadtune::internal {

template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<12>(const PreparedModel&);
template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<16>(const PreparedModel&);
template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<24>(const PreparedModel&);

}  // namespace quadtune::internal
