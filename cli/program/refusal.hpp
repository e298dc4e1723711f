// SPDX-License-Identifier: Apache-2.0
/// An answer that is no before there is anything to print.
#pragma once

#include <string>
#include <utility>

#include "program/program.hpp"

namespace quadtune::cli {

/// Unlike any other AnswerIsNo it is told as an error is: with --json as an object, and without a
/// file that -o names.
class Refusal : public AnswerIsNo {
 public:
  /// @param where  the file or vehicle concerned, for scripts.
  Refusal(const std::string& message, std::string where)
      : AnswerIsNo(message), where_(std::move(where)) {}

  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::string where_;
};

}  // namespace quadtune::cli
