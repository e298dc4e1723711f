// SPDX-License-Identifier: Apache-2.0
#include "program/library_messages.hpp"

#include <glog/logging.h>  // of Ceres, which warns of line searches that end at once

namespace quadtune::cli {

void silence_libraries() { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace quadtune::cli
