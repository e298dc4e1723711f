// SPDX-License-Identifier: Apache-2.0
#include "built_in_exporters.hpp"
#include "quadtune/exports/flight_code.hpp"

namespace quadtune::exports {

Exporter flight_code_exporter() {
  // The C is not parsed: the laws are read from the gains.json that is exported with it.
  Exporter exporter = json_exporter();
  exporter.target = export_target("c", "exporter");
  exporter.files = flight_code_files;
  exporter.read_plain = {};
  exporter.weights_difference = {};  // written_again compares gains.json whole
  return exporter;
}

}  // namespace quadtune::exports
