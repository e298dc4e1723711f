// SPDX-License-Identifier: Apache-2.0
/// What `certify` proved and found, as text and JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/synthesis/robustness.hpp"
#include "quadtune/workbench/flown/flown_box.hpp"

namespace quadtune::report {

/// One law of an export.
struct CertifiedLaw {
  std::string name;  ///< "state feedback" or "cascade"
  double dt = 0;     ///< [s]
  LoopFamily family;
  Robustness robustness;
  std::optional<FlownBox> flown = {};  ///< none with --plant ideal

  /// Whether a vehicle of the box was found whose flown loop grows.
  [[nodiscard]] bool flown_unstable() const {
    return flown && flown->worst && flown->worst->grows();
  }
  /// Whether the whole box is proved, and means something.
  [[nodiscard]] bool proved() const;
  /// Why not, in words; empty if it is.
  [[nodiscard]] std::string reason() const;
};

struct CertifyReport {
  std::string directory;
  std::string vehicle;
  std::vector<CertifiedLaw> laws;

  [[nodiscard]] bool proved() const;
  /// "proved", "unstable" where a search found such a loop in the box, else "not proved".
  [[nodiscard]] std::string verdict() const;
};

[[nodiscard]] internal::Json to_json(const CertifyReport& report);
[[nodiscard]] std::string to_text(const CertifyReport& report);

}  // namespace quadtune::report
