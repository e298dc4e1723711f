// SPDX-License-Identifier: Apache-2.0
/// What joins a flight program to the board that it is for: a main program, a controller of another
/// firmware, a module, a shared object.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"

namespace quadtune::exports {

struct AdapterFile {
  std::string from;  ///< in source/
  std::string to;    ///< name of the exported file
};

/// @param adapter  a word of flight_code_adapters()
[[nodiscard]] std::vector<AdapterFile> adapter_files(const std::string& adapter);

/// Whether the firmware that the adapter is for brings the estimate, so that the program needs
/// none.
[[nodiscard]] bool adapter_estimates(const std::string& adapter);

/// A source of an adapter with what stands there for this vehicle and program: QT_ROTORS_OF_MOTORS,
/// QT_STEPS_PER_PERIOD and QtModule. They are words that a formatter of C leaves whole.
/// @param from  AdapterFile::from
/// @param name  the program's
[[nodiscard]] std::string adapter_text(const std::string& from, const ExportContent& content,
                                       const std::string& name, double dt);

/// @throws InvalidInput  for a control period that the board does not have, a precision that its
///                       structures do not have, or a vehicle that it cannot mix
void require_adapter(const ExportContent& content, double dt);

/// How to build it, for the program's README.
[[nodiscard]] std::string adapter_page(const std::string& adapter);

}  // namespace quadtune::exports
