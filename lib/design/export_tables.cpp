// SPDX-License-Identifier: Apache-2.0
#include "design/export_tables.hpp"

#include <fmt/format.h>

#include "quadtune/design/export_target.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {

std::vector<ExportRequest> read_exports(const TomlTable& file, const Design& design) {
  std::vector<ExportRequest> exports;
  for (const TomlTable& table : file.tables("export")) {
    table.allow({{"to"},
                 {"name"},
                 {"precision"},
                 {"law"},
                 {"adapter"},
                 {"firmware"},
                 {"setup"},
                 {"filter_noise"}});
    ExportRequest request{table.text("to")};
    const std::string where = table.where("to");
    const ExportTarget& target = export_target(request.to, where);
    for (const ExportRequest& earlier : exports)
      if (earlier.to == request.to)
        throw InvalidInput(where,
                           "export to '" + request.to + "' is requested twice, expected once");
    const bool matrix = design.lqi && design.lqi->matrix;
    if (target.is_firmware && !design.cascade)
      throw InvalidInput(where, fmt::format("export to '{}' has no gains to write, expected a "
                                            "[cascade] table, because this firmware cannot fly "
                                            "state feedback",
                                            request.to));
    if (!target.takes_memory && !target.is_firmware && design.lqi && !matrix)
      throw InvalidInput(where, fmt::format("export to '{}' cannot hold the past commands and "
                                            "lags of a law with lqr.plant 'flown', expected json, "
                                            "or lqr.structure 'matrix'",
                                            request.to));
    if (target.needs_gains && !design.lqr && !matrix)
      throw InvalidInput(where, fmt::format("export to '{}' has no gains to write, expected an "
                                            "[lqr] table",
                                            request.to));
    for (const char* key : {"name", "precision", "law", "adapter"})
      if (request.to != "c" && !table.text_or(key, "").empty())
        throw InvalidInput(table.where(key),
                           fmt::format("export.{} applies only to an export to 'c', "
                                       "expected no such key for '{}'",
                                       key, request.to));
    for (const char* key : {"firmware", "setup", "filter_noise"})
      if (!target.is_firmware && table.has(key))
        throw InvalidInput(table.where(key),
                           fmt::format("export.{} applies only to firmware parameters, expected "
                                       "no such key for '{}'",
                                       key, request.to));
    request.firmware = {table.text_or("firmware", ""), table.text_or("setup", ""),
                        table.has("filter_noise") && table.truth("filter_noise")};
    request.flight_code.name = table.text_or("name", "");
    request.flight_code.double_precision =
        is_double_precision(table.text_or("precision", "float"), table.where("precision"));
    request.flight_code.law = table.text_or("law", "");
    if (!request.flight_code.name.empty())
      require_flight_code_name(request.flight_code.name, table.where("name"));
    if (!request.flight_code.law.empty())
      require_flight_code_law(request.flight_code.law, table.where("law"));
    request.flight_code.adapter = table.text_or("adapter", "");
    if (!request.flight_code.adapter.empty())
      require_flight_code_adapter(request.flight_code.adapter, table.where("adapter"));
    exports.push_back(request);
  }
  return exports;
}

}  // namespace quadtune::internal
