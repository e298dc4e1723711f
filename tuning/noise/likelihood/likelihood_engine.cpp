// SPDX-License-Identifier: Apache-2.0
#include "noise/likelihood/likelihood_engine.hpp"

namespace quadtune::internal {

extern template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<2>(
    const PreparedModel&);
extern template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<4>(
    const PreparedModel&);
extern template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<8>(
    const PreparedModel&);
extern template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<12>(
    const PreparedModel&);
extern template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<16>(
    const PreparedModel&);
extern template std::unique_ptr<LikelihoodEngine> make_likelihood_engine_of<24>(
    const PreparedModel&);

std::unique_ptr<LikelihoodEngine> make_likelihood_engine(const PreparedModel& prepared) {
  const Eigen::Index nx = prepared.model.A.rows();
  if (nx <= 2) return make_likelihood_engine_of<2>(prepared);
  if (nx <= 4) return make_likelihood_engine_of<4>(prepared);
  if (nx <= 8) return make_likelihood_engine_of<8>(prepared);
  if (nx <= 12) return make_likelihood_engine_of<12>(prepared);
  if (nx <= 16) return make_likelihood_engine_of<16>(prepared);
  return make_likelihood_engine_of<24>(prepared);
}

}  // namespace quadtune::internal
