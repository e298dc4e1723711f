// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/compiled_eigen.hpp"

QUADTUNE_EIGEN_SINGULAR_VALUES(template)
