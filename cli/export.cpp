// SPDX-License-Identifier: Apache-2.0
/// quadtune export: a gain set or a design, written for another program.
#include "quadtune/exports/export.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <ostream>

#include "quadtune/workbench/design/given_gains.hpp"
#include "arguments/trusted_covariances.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/export_content.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "report/gains/export_report.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string source, to, directory, vehicle;
};

/// An export over its own source would take away what it does not carry over.
void refuse_own_source(const Options& options) {
  std::error_code ignored;
  if (std::filesystem::equivalent(options.source, options.directory, ignored))
    throw UsageError(fmt::format("quadtune export: -o {} is the source itself, expected another "
                                 "directory",
                                 options.directory),
                     "-o");
}

/// Laws from files, with the vehicle that they are for.
ExportContent read_content(const Options& options) {
  ExportContent content;
  GivenLaws given = read_given_laws(options.source);
  content.gains = std::move(given.laws.gains);
  content.cascade = std::move(given.laws.cascade);
  content.estimator = std::move(given.laws.estimator);
  if (content.gains && !(content.gains->dt > 0))
    throw InvalidInput(options.source,
                       "the gains are continuous, expected those of a sample period, e.g. by "
                       "`quadtune lqr V --method sampled --dt T`, because a computer flies them");
  const std::string vehicle = options.vehicle.empty() ? given.laws.vehicle : options.vehicle;
  if (vehicle.empty())
    throw UsageError(
        "quadtune export: the gains do not say for which vehicle they are, expected "
        "--vehicle V",
        "--vehicle");
  content.vehicle = load_vehicle(vehicle);
  if (content.gains) content.gains->vehicle = content.vehicle.name;
  if (content.cascade)
    content.cascade_plant = cascade_plant(content.vehicle, *content.cascade, options.source);
  content.versions = library_versions();
  content.inputs = {{vehicle_file_name(content.vehicle), content.vehicle.text}};
  return content;
}

bool is_design(const std::string& path) { return path.ends_with(".toml"); }

ExportContent design_content(const std::string& path, Context& context) {
  const DesignOutcome outcome = run_design(path);
  require_tuned(outcome, false, context);
  return export_content(outcome);
}

ExportContent make_content(const Options& options, ExportKind kind, Context& context) {
  ExportContent content =
      is_design(options.source) ? design_content(options.source, context) : read_content(options);
  if (content.gains && kind != ExportKind::json)
    content.gains = in_convention(
        *content.gains, convention(kind == ExportKind::uquad ? "uquad" : "mambo", "--to"));
  if (content.gains && content.gains->dt > 0) {
    const VerifyModel model = model_of(content.vehicle, *content.gains);
    content.plant = model.plant;
    // The flight program's K*.txt have no trim.
    if (content.gains->u0.isZero(0)) {
      content.gains->u0 = model.u0;
      context.note(fmt::format("export: note: the gains come without a trim; that of {} is taken",
                               content.vehicle.name));
    }
  }
  return content;
}

/// Gains that do not hold the vehicle are not written.
void require_stable(const ExportContent& content) {
  const auto require = [&](const char* what, const Eigen::VectorXcd& poles) {
    const double radius = poles.cwiseAbs().maxCoeff();
    if (!(radius < 1))
      throw Refusal(fmt::format("export: the loop of {} with {} is unstable (spectral radius "
                                "{:.6g}), nothing was written",
                                what, content.vehicle.name, radius),
                    content.vehicle.name);
  };
  if (content.gains && content.plant)
    require("these gains", closed_loop_poles(*content.plant, *content.gains));
  if (content.cascade && content.cascade_plant)
    require("this cascade", closed_loop_poles(*content.cascade_plant, *content.cascade));
}

}  // namespace

internal::Json to_json(const std::vector<ManifestFile>& files) {
  internal::Json json = internal::Json::array();
  for (const ManifestFile& file : files)
    json.push_back({{"path", file.path}, {"sha256", file.sha256}});
  return json;
}

Verb export_verb() {
  return {
      "export", "DIR|FILE --to NAME -o DIR",
      "write gains, or what a design gives, for another program",
      "quadtune export designs/uquad-hover.toml --to json -o out/uquad-json",
      [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("SOURCE", options->source,
                        "an export's directory, a gain file or a design file (.toml)");
        line.add_option("--to", options->to, "uquad, mambo or json")->type_name("NAME");
        line.add_option("-o", options->directory, "directory to write")->type_name("DIR");
        line.add_option("--vehicle", options->vehicle, "the vehicle, where the gains do not say")
            ->type_name("V");
        return [options](Context& context) {
          if (options->source.empty() || options->to.empty() || options->directory.empty())
            throw UsageError("quadtune export: expected a source, --to NAME and -o DIR",
                             options->source.empty() ? "SOURCE"
                             : options->to.empty()   ? "--to"
                                                     : "-o");
          refuse_own_source(*options);
          const ExportKind kind = export_kind(options->to, "--to");
          const ExportContent content = make_content(*options, kind, context);
          require_stable(content);
          if (!is_design(options->source))
            context.note(
                "export: note: gains, trim, cascade and vehicle are carried over; weights and "
                "filters come from a design file only");
          std::vector<ManifestFile> files;
          {
            const WritingFiles writing;
            files = write_export(options->directory, kind, content, interrupted);
            context.written.push_back(options->directory);
          }
          if (context.json) {
            const internal::Json json = {{"files", to_json(files)}};
            context.out << internal::readable(json) << "\n";
            return;
          }
          for (const ManifestFile& file : files)
            context.out << fmt::format("{}  {}/{}\n", file.sha256, options->directory, file.path);
        };
      }};
}

}  // namespace quadtune::cli
