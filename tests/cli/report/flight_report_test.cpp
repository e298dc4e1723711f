// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <fstream>
#include "sample_flight.hpp"
TEST(A,B){ std::ofstream("/tmp/scratch/r.html") << quadtune::cli::html(quadtune::testing::sample_flight()); }
