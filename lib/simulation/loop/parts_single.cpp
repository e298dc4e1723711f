// SPDX-License-Identifier: Apache-2.0
#include "simulation/loop/common_parts.hpp"

QUADTUNE_LOOP_PARTS(template, 1)
