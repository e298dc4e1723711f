// SPDX-License-Identifier: Apache-2.0
/// Adapters between a flight program and its target board: a main program, a controller of another
/// firmware, a module, or a shared object.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"

namespace quadtune::exports {

struct AdapterFile {
  std::string from;  ///< in source/
  std::string to;    ///< name of the exported file
};

/// @param adapter  one of flight_code_adapters()
[[nodiscard]] std::vector<AdapterFile> adapter_files(const std::string& adapter);

/// Whether the firmware of the adapter provides the estimate, so that the program needs no
/// estimator.
[[nodiscard]] bool adapter_estimates(const std::string& adapter);

/// A source of an adapter with the values of this vehicle and program in place of
/// QT_ROTORS_OF_MOTORS, QT_STEPS_PER_PERIOD and QtModule. These placeholders are identifiers, which
/// a C formatter does not break.
/// @param from  AdapterFile::from
/// @param name  name of the program
[[nodiscard]] std::string adapter_text(const std::string& from, const ExportContent& content,
                                       const std::string& name, double dt);

/// @throws InvalidInput  if the board does not support the control period, its structures the
///                       precision, or its mixer the vehicle
void require_adapter(const ExportContent& content, double dt);

/// Build instructions, for the program's README.
[[nodiscard]] std::string adapter_page(const std::string& adapter);

}  // namespace quadtune::exports
