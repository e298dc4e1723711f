// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "export_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/diff.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "verify/written_version.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

// Trims are solved to 1e-10, so two solutions for one flight agree to within this share of their
// largest entry, or of 1 in its unit.
constexpr double kTrimTolerance = 1e-7;

VerifyCheck check_file(const fs::path& directory, const ManifestFile& file) {
  VerifyCheck check{file.path + " matches the manifest", false, ""};
  try {
    const std::string bytes = exports::export_bytes(directory / file.path);
    if (bytes.size() != file.size)
      check.detail = fmt::format("has {} bytes, the manifest lists {}", bytes.size(), file.size);
    else if (sha256(bytes) != file.sha256)
      check.detail =
          fmt::format("has SHA-256 {}, the manifest lists {}", sha256(bytes), file.sha256);
    else
      check.detail = "SHA-256 " + file.sha256;
    check.ok = bytes.size() == file.size && sha256(bytes) == file.sha256;
  } catch (const FileError& error) {
    check.detail = error.what();
  } catch (const InvalidInput& error) {
    check.detail = error.what();
  }
  return check;
}

// All names of files in which any flight program would look for gains.
std::vector<std::string> all_gain_files() {
  std::vector<std::string> all;
  for (const Exporter& exporter : exporters())
    all.insert(all.end(), exporter.gain_files.begin(), exporter.gain_files.end());
  return all;
}

VerifyCheck check_no_others(const fs::path& directory, const Manifest& manifest) {
  std::vector<std::string> others;
  for (const std::string& name : all_gain_files())
    if (fs::exists(directory / name) &&
        std::none_of(manifest.files.begin(), manifest.files.end(),
                     [&](const ManifestFile& file) { return file.path == name; }))
      others.push_back(name);
  const std::vector<std::string>& own = exporter_of(manifest.kind, kManifestName).gain_files;
  for (const std::string& name : all_gain_files())
    if (name != kGainsJsonName && std::find(own.begin(), own.end(), name) == own.end() &&
        std::any_of(manifest.files.begin(), manifest.files.end(),
                    [&](const ManifestFile& file) { return file.path == name; }))
      return {"no other gain files", false,
              fmt::format("{} is listed in the manifest, but an export to {} has no such file",
                          name, manifest.kind.name())};
  if (others.empty()) return {"no other gain files", true, "none"};
  return {"no other gain files", false,
          fmt::format("{} not listed in the manifest, but a flight program would load it",
                      internal::joined(others, ", "))};
}

// Inputs are identified by name only. Reports which of them are available, and whether these are
// unchanged.
VerifyCheck check_inputs(const Manifest& manifest, const std::vector<InputAtHand>& at_hand) {
  VerifyCheck check{"inputs are those of the manifest", true, ""};
  std::vector<std::string> same, missing;
  for (const ManifestFile& input : manifest.inputs) {
    const auto named = [&](const InputAtHand& file) { return file.name == input.path; };
    const auto as_listed = [&](const InputAtHand& file) {
      return named(file) && file.bytes.size() == input.size && sha256(file.bytes) == input.sha256;
    };
    if (std::any_of(at_hand.begin(), at_hand.end(), as_listed)) {
      same.push_back(input.path);
      continue;
    }
    const auto other = std::find_if(at_hand.begin(), at_hand.end(), named);
    if (other == at_hand.end()) {
      missing.push_back(input.path);
      continue;
    }
    check.ok = false;
    check.detail = fmt::format(
        "{} has {} bytes and SHA-256 {}, the manifest lists {} and {}: the export was made from "
        "another file; name it with --design or --vehicle",
        other->where.empty() ? input.path : internal::printable(other->where), other->bytes.size(),
        sha256(other->bytes), input.size, input.sha256);
    return check;
  }
  if (!same.empty()) check.detail = fmt::format("{} as listed", internal::joined(same, ", "));
  if (!missing.empty())
    check.detail += fmt::format("{}not at hand, so not compared: {}", same.empty() ? "" : "; ",
                                internal::joined(missing, ", "));
  if (check.detail.empty()) check.detail = "the manifest lists none";
  return check;
}

std::string describe(const StoredLaws& laws) {
  std::string text;
  if (laws.gains)
    text = fmt::format("K {}x{}, K_int {}x{}, all finite", laws.gains->K.rows(),
                       laws.gains->K.cols(), laws.gains->K_int.rows(), laws.gains->K_int.cols());
  if (laws.cascade) text += fmt::format("{}a PID cascade", text.empty() ? "" : "; ");
  return text.empty() ? "no control law in this export" : text;
}

void check_readable(const fs::path& directory, const Manifest* manifest, VerifyReport& report) {
  VerifyCheck check{"files read as the flight program reads them", false, ""};
  try {
    StoredLaws laws = read_laws(directory);
    if (manifest != nullptr && manifest->gains && !laws.gains)
      throw InvalidInput(directory.string(), "has no state feedback, but its manifest has");
    if (manifest != nullptr && manifest->cascade && !laws.cascade)
      throw InvalidInput(directory.string(), "has no cascade, but its manifest has");
    if (laws.gains && manifest != nullptr)
      if (const auto& check_files = exporter_of(manifest->kind, kManifestName).check)
        check_files(directory, *manifest, *laws.gains);
    check.detail = !laws.gains && !laws.cascade && holds_schedule(directory) ? "a gain schedule"
                                                                             : describe(laws);
    check.ok = true;
    report.gains = std::move(laws.gains);
    report.cascade = std::move(laws.cascade);
  } catch (const InvalidInput& error) {
    check.detail = error.what();
  } catch (const FileError& error) {
    check.detail = error.what();
  }
  report.checks.push_back(check);
}

// x0 with its entries in the order of `states`; zero for a state that the gains do not have.
Eigen::VectorXd in_order_of(const Gains& gains, const std::vector<Signal>& states) {
  Eigen::VectorXd x0 = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i)
    for (std::size_t j = 0; j < gains.states.size(); ++j)
      if (gains.states[j].name == states[i].name)
        x0(static_cast<Eigen::Index>(i)) = gains.x0(static_cast<Eigen::Index>(j));
  return x0;
}

// How the signals `found` differ from `expected`, or "": K has no meaning without its signals.
std::string signal_difference(const char* what, const std::vector<Signal>& found,
                              const std::vector<Signal>& expected, bool in_this_order) {
  for (std::size_t i = 0; i < std::max(found.size(), expected.size()); ++i) {
    if (i >= found.size() || i >= expected.size())
      return fmt::format("{} {}, the manifest has {}", what, names(found), names(expected));
    const auto same_name = [&](const Signal& signal) { return signal.name == found[i].name; };
    const auto at = in_this_order ? expected.begin() + static_cast<std::ptrdiff_t>(i)
                                  : std::find_if(expected.begin(), expected.end(), same_name);
    if (at == expected.end() || at->name != found[i].name)
      return fmt::format("{} {}, the manifest has {}", what, names(found), names(expected));
    if (at->unit != found[i].unit)
      return fmt::format("{} in '{}', the manifest has '{}'", found[i].name, found[i].unit,
                         at->unit);
  }
  return "";
}

// Compares everything about the gains except their numbers.
std::string description_difference(const Gains& read, const Gains& expected) {
  const auto differ = [](const char* what, const std::string& a, const std::string& b) {
    return a == b ? "" : fmt::format("{} {} in the file, {} in the manifest", what, a, b);
  };
  for (const std::string& difference :
       {differ("sign law", to_string(read.sign_law), to_string(expected.sign_law)),
        differ("convention", read.convention, expected.convention),
        differ("kind of inputs", to_string(read.input_kind), to_string(expected.input_kind)),
        differ("sample time", fmt::format("{}", read.dt), fmt::format("{}", expected.dt)),
        signal_difference("inputs", read.inputs, expected.inputs, true),
        signal_difference("states", read.states, expected.states, false),
        signal_difference("integrals", read.integrals, expected.integrals, false)})
    if (!difference.empty()) return difference;
  return "";
}

VerifyCheck check_same_gains(const Gains& read, const Gains& expected) {
  VerifyCheck check{"gains are those of the manifest", false, ""};
  try {
    check.detail = description_difference(read, expected);
    if (!check.detail.empty()) return check;
    const GainsDiff difference = diff(read, expected);
    check.ok = difference.entries.empty();
    check.detail = "every entry is the same double";
    if (check.ok && (read.x0 != in_order_of(expected, read.states) || read.u0 != expected.u0)) {
      check.ok = false;
      check.detail = "trim x0 or u0 differs";
    }
    if (!difference.entries.empty()) {
      const DiffEntry& worst = difference.entries.front();
      check.detail = fmt::format("{} {}, most {}({}, {}): {} in the file, {} in the manifest",
                                 internal::counted(difference.entries.size(), "entry", "entries"),
                                 difference.entries.size() == 1 ? "differs" : "differ",
                                 worst.matrix, worst.input, worst.state, worst.a, worst.b);
    }
  } catch (const InvalidInput& error) {
    check.detail = error.what();
  }
  return check;
}

VerifyCheck check_same_cascade(const CascadeDesign& read, const CascadeDesign& expected) {
  const GainsDiff difference = diff(read, expected);
  if (difference.entries.empty())
    return {"cascade is that of the manifest", true, "every number is the same double"};
  const DiffEntry& worst = difference.entries.front();
  return {"cascade is that of the manifest", false,
          fmt::format("{} {}, most {}: {} in the file, {} in the manifest",
                      internal::counted(difference.entries.size(), "number"),
                      difference.entries.size() == 1 ? "differs" : "differ", name_of(worst),
                      worst.a, worst.b)};
}

VerifyCheck check_weights(const fs::path& directory, const Manifest& manifest,
                          const Exporter& exporter) {
  VerifyCheck check{"weights are those of the manifest", false, ""};
  try {
    check.detail = exporter.weights_difference(directory, manifest);
    check.ok = check.detail.empty();
    if (check.ok)
      check.detail = manifest.Q.size() + manifest.R.size() > 0 ? "every entry is the same double"
                                                               : "the export has none";
  } catch (const InvalidInput& error) {
    check.detail = error.what();
  } catch (const FileError& error) {
    check.detail = error.what();
  }
  return check;
}

VerifyCheck check_numbers(const fs::path& directory, const Manifest& manifest,
                          const Exporter& exporter) {
  VerifyCheck check{"single numbers, besides gains and weights, are those of the manifest", false,
                    ""};
  try {
    std::vector<NamedMatrix> found;
    for (const ManifestFile& file : manifest.files)
      for (NamedMatrix& number : exporter.numbers(
               {(directory / file.path).string(), exports::export_bytes(directory / file.path)})) {
        number.file = file.path;
        found.push_back(std::move(number));
      }
    for (const NamedMatrix& expected : manifest.numbers) {
      const auto same_name = [&](const NamedMatrix& number) {
        return number.file == expected.file && number.name == expected.name;
      };
      const auto at = std::find_if(found.begin(), found.end(), same_name);
      const std::string name = expected.file + ": " + expected.name;
      if (at == found.end()) {
        check.detail = name + " is missing";
        return check;
      }
      if (at->value.rows() != expected.value.rows() || at->value.cols() != expected.value.cols() ||
          at->value != expected.value || at->text != expected.text) {
        check.detail = name + " differs";
        return check;
      }
    }
    // An older version of quadtune listed fewer of them.
    check.ok = found.size() == manifest.numbers.size() || !exports::is_of_this_version(manifest);
    check.detail = found.empty() && manifest.numbers.empty()
                       ? "there are none"
                       : fmt::format("the files have {} of them, the manifest lists {}",
                                     found.size(), manifest.numbers.size());
  } catch (const InvalidInput& error) {
    check.detail = error.what();
  } catch (const FileError& error) {
    check.detail = error.what();
  }
  return check;
}

// "" if `found` equals `expected` up to kTrimTolerance, else the entry with the largest difference.
std::string trim_difference(const char* name, const std::vector<Signal>& signals,
                            const Eigen::VectorXd& found, const Eigen::VectorXd& expected) {
  if (found.size() != expected.size())
    return fmt::format("{} has {}, the vehicle's trim has {}", name,
                       internal::counted(found.size(), "entry", "entries"), expected.size());
  Eigen::Index worst = 0;
  const double largest = (found - expected).cwiseAbs().maxCoeff(&worst);
  if (largest <= kTrimTolerance * std::max(1.0, expected.cwiseAbs().maxCoeff())) return "";
  return fmt::format("{}({}) is {}, the vehicle's trim has {}", name,
                     signals[static_cast<std::size_t>(worst)].name, found(worst), expected(worst));
}

VerifyCheck check_trim(const Gains& gains, const std::optional<VerifyModel>& model) {
  VerifyCheck check{"trim is the vehicle's", false, "not computed: no vehicle to trim"};
  if (!model) return check;
  Gains expected = gains;
  expected.states = model->plant.states;
  expected.x0 = model->x0;
  check.detail = trim_difference("x0", gains.states, gains.x0, in_order_of(expected, gains.states));
  if (check.detail.empty()) check.detail = trim_difference("u0", gains.inputs, gains.u0, model->u0);
  check.ok = check.detail.empty();
  if (check.ok) check.detail = "with x0 and u0, the vehicle remains in steady flight";
  return check;
}

VerifyCheck check_poles(const char* name, const Eigen::VectorXcd& found,
                        const Eigen::VectorXcd& listed) {
  VerifyCheck check{name, false, "no poles could be computed"};
  if (listed.size() == 0) {
    check.detail = "the manifest lists none";
  } else if (found.size() == listed.size()) {
    const double distance = pole_distance(found, listed);
    check.ok = distance <= kPoleTolerance;
    check.detail = fmt::format("largest distance {:.3g}, at most {:g}", distance, kPoleTolerance);
  } else if (found.size() > 0) {
    check.detail = fmt::format("{} poles, the manifest lists {}", found.size(), listed.size());
  }
  return check;
}

void check_closed_loop(const std::optional<VerifyModel>& model, const Manifest* manifest,
                       VerifyReport& report) {
  const DiscreteLti* plant = model ? &model->plant : nullptr;
  VerifyCheck stable{"stability of the closed loop", false, "no gains could be read"};
  if (report.gains && !plant) stable.detail = "not computed: no vehicle to close the loop with";
  if (report.gains && plant) {
    try {
      report.poles = closed_loop_poles(*plant, *report.gains);
      const double radius = report.poles.cwiseAbs().maxCoeff();
      stable.ok = radius < 1;
      stable.detail = fmt::format(
          "spectral radius {:.9f} with u = u0 + K {}, dt {} s", radius,
          report.gains->sign_law == SignLaw::set_point_minus_state ? "(x_sp - x)" : "(x - x_sp)",
          plant->dt);
    } catch (const InvalidInput& error) {
      stable.detail = error.what();
    }
  }
  report.checks.push_back(stable);
  if (report.gains && plant && report.gains->dt > 0)
    report.checks.push_back({"sample time is the vehicle model's",
                             std::abs(plant->dt - report.gains->dt) <= 1e-12,
                             fmt::format("gains {} s, model {} s", report.gains->dt, plant->dt)});
  if (manifest != nullptr)
    report.checks.push_back(
        check_poles("poles are those of the manifest", report.poles, manifest->closed_loop_poles));
}

void check_cascade_loop(const std::optional<DiscreteLti>& plant, const Manifest* manifest,
                        VerifyReport& report) {
  VerifyCheck stable{"closed loop of the cascade is stable", false,
                     "not computed: no vehicle to close the loop with"};
  Eigen::VectorXcd poles;
  if (plant) {
    try {
      poles = closed_loop_poles(*plant, *report.cascade);
      const double radius = poles.cwiseAbs().maxCoeff();
      stable.ok = radius < 1 && std::abs(plant->dt - report.cascade->gains.dt) <= 1e-12;
      stable.detail =
          fmt::format("spectral radius {:.9f}, all loops closed, integrals by {}, dt {} s", radius,
                      to_string(report.cascade->method), plant->dt);
    } catch (const InvalidInput& error) {
      stable.detail = error.what();
    }
  }
  report.checks.push_back(stable);
  // If the manifest does not contain the cascade, the numbers of its files are compared instead.
  if (manifest != nullptr && manifest->cascade)
    report.checks.push_back(check_poles("poles of the cascade are those of the manifest", poles,
                                        manifest->cascade_poles));
}

// The first member of `found` that differs in `expected` or is missing there; "" if there is none.
std::string other_member(const internal::Json& found, const internal::Json& expected) {
  for (const std::string& key : found.keys())
    if (!expected.contains(key) || !(found[key] == expected[key])) return internal::printable(key);
  return "";
}

std::optional<Manifest> check_manifest(const fs::path& directory, VerifyReport& report) {
  VerifyCheck check{"manifest", false, ""};
  std::optional<Manifest> manifest;
  try {
    manifest = read_manifest(directory);
    check.ok = !manifest->gains || manifest->gains->vehicle == manifest->vehicle;
    check.detail =
        fmt::format("{} export of {}, {}{}", to_string(manifest->kind), manifest->vehicle,
                    internal::counted(manifest->files.size(), "file"),
                    check.ok ? "" : ", but the gains are of " + manifest->gains->vehicle);
    if (check.ok && exports::is_of_this_version(*manifest)) {
      const std::string member =
          other_member(internal::Json::parse(exports::export_text(directory / kManifestName)),
                       internal::Json::parse(manifest_text(*manifest)));
      check.ok = member.empty();
      if (!check.ok) check.detail = fmt::format("'{}' differs from that of an export", member);
    }
  } catch (const InvalidInput& error) {
    check.detail = error.what();
  } catch (const FileError& error) {
    check.detail = error.what();
  }
  report.checks.push_back(check);
  return manifest;
}

}  // namespace

bool VerifyReport::ok() const {
  return !checks.empty() &&
         std::all_of(checks.begin(), checks.end(), [](const VerifyCheck& c) { return c.ok; });
}

double pole_distance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  std::vector<std::complex<double>> left(b.begin(), b.end());
  double worst = 0;
  for (const std::complex<double>& pole : a) {
    const auto nearest = std::min_element(left.begin(), left.end(), [&](auto x, auto y) {
      return std::abs(x - pole) < std::abs(y - pole);
    });
    worst = std::max(worst, std::abs(*nearest - pole));
    left.erase(nearest);
  }
  return worst;
}

VerifyReport verify_export(const fs::path& directory, const std::optional<VerifyModel>& model,
                           const VerifyFacts& facts) {
  std::error_code error;
  if (!fs::is_directory(directory, error))
    throw FileError(
        directory.string(),
        error ? error.message() : "is not a directory; expected the directory of an export");
  VerifyReport report;
  const std::optional<Manifest> manifest = check_manifest(directory, report);
  if (manifest) {
    for (const ManifestFile& file : manifest->files)
      report.checks.push_back(check_file(directory, file));
    report.checks.push_back(check_no_others(directory, *manifest));
    report.checks.push_back(check_inputs(*manifest, facts.inputs));
  }
  check_readable(directory, manifest ? &*manifest : nullptr, report);
  if (manifest && manifest->gains && report.gains)
    report.checks.push_back(check_same_gains(*report.gains, *manifest->gains));
  const Exporter* exporter =
      manifest ? &exporter_of(manifest->kind, (directory / kManifestName).string()) : nullptr;
  if (manifest && report.cascade && (manifest->cascade || !exporter->always_has_cascade))
    report.checks.push_back(
        manifest->cascade
            ? check_same_cascade(*report.cascade, *manifest->cascade)
            : VerifyCheck{"cascade is that of the manifest", false, "the manifest has none"});
  if (manifest && manifest->gains && exporter->weights_difference)
    report.checks.push_back(check_weights(directory, *manifest, *exporter));
  if (manifest && exporter->numbers)
    report.checks.push_back(check_numbers(directory, *manifest, *exporter));
  if (manifest && manifest->gains && report.gains)
    report.checks.push_back(check_trim(*report.gains, model));
  const Manifest* known = manifest ? &*manifest : nullptr;
  if (!manifest || manifest->gains || report.gains) check_closed_loop(model, known, report);
  if (report.cascade) check_cascade_loop(facts.cascade_plant, known, report);
  return report;
}

}  // namespace quadtune
