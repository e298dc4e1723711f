// SPDX-License-Identifier: Apache-2.0
// Verification of exports: 400 seeded corruptions of every format are rejected except those listed
// with a reason, which are rejected with the design file, and 400 intact exports are accepted.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/mambo.hpp"
#include "quadtune/exports/text_difference.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "quadtune/workbench/export/gains_export.hpp"
#include "quadtune/workbench/verify/verify_design.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryDirectory;
using Random = std::mt19937_64;
using Files = std::map<std::string, std::string>;  // name, bytes

constexpr int kExports = testing::kSanitized ? 15 : 400;
constexpr int kCorruptions = testing::kSanitized ? 15 : 400;

constexpr char kParametersDesign[] = R"(
name = "parameters"
vehicle = "VEHICLE"
[cascade]
dt_s = 0.004
[cascade.design]
structure = "p-pi"
)";

Design written_design(const TemporaryDirectory& folder, const std::string& text) {
  return load_design(folder.write("parameters.toml", text));
}

Design parameters_design(const std::string& vehicle) {
  const TemporaryDirectory folder;
  std::string text = kParametersDesign;
  const std::string file = testing::source_folder() + "/vehicles/" + vehicle + ".toml";
  return written_design(folder, text.replace(text.find("VEHICLE"), 7, file));
}

Design built_in_design(const std::string& name) {
  return load_design(fs::path(testing::source_folder()) / "designs" / (name + ".toml"));
}

// A solved design with its possible exports.
struct Source {
  DesignOutcome outcome;
  std::vector<std::string> kinds;
};

std::vector<std::string> kinds_of(const std::string& design) {
  if (design == "uquad-hover") return {"uquad", "json", "mat", "c"};
  if (design == "mambo-hover") return {"mambo", "json", "c"};
  if (design == "crazyflie") return {"crazyflie", "mat"};
  return {"px4", "ardupilot", "betaflight", "json"};
}

Design design_named(const std::string& name) {
  return name.ends_with("-hover") ? built_in_design(name) : parameters_design(name);
}

// The same design for a vehicle that differs by some per cent.
Design varied(Design design, Random& random) {
  std::uniform_real_distribution<double> factor(0.95, 1.05);
  design.vehicle.mass *= factor(random);
  design.vehicle.inertia *= factor(random);
  if (design.lqr) {
    design.lqr->Q *= factor(random);
    design.lqr->R *= factor(random);
    design.published.reset();
  }
  return design;
}

ExportContent content_for(const DesignOutcome& outcome, const std::string& kind) {
  ExportContent content = export_content(outcome);
  content.flight_code.law = outcome.gains && outcome.cascade ? "cascaded-pid" : "";
  content.firmware.filter_noise = kind == "px4" || kind == "crazyflie";
  (void)adapt_to_program(content, ExportKind(kind));
  return content;
}

VerifyReport verified(const fs::path& directory, const DesignOutcome& outcome) {
  std::vector<InputAtHand> inputs;
  for (const FileContent& input : export_content(outcome).inputs)
    inputs.push_back({input.name, "", input.bytes});
  return verify_with(directory.string(), outcome.design.vehicle, inputs, &outcome.flown, {});
}

std::string failures(const VerifyReport& report) {
  std::string text;
  for (const VerifyCheck& check : report.checks)
    if (!check.ok) text += check.name + ": " + check.detail + "\n";
  return text;
}

TEST(ExportCorruptions, NoneOf400IntactExportsIsRejected) {
  const std::vector<std::string> names = {"uquad-hover", "mambo-hover", "quad-450", "crazyflie"};
  Random random(1);
  std::map<std::string, int> of_kind;
  int count = 0;
  for (std::size_t i = 0; count < kExports; ++i) {
    const std::string& name = names[i % names.size()];
    const DesignOutcome outcome = run_design(varied(design_named(name), random));
    for (const std::string& kind : kinds_of(name)) {
      const TemporaryDirectory directory;
      write_export(directory.path(), ExportKind(kind), content_for(outcome, kind));
      const VerifyReport report = verified(directory.path(), outcome);
      ASSERT_TRUE(report.ok()) << name << " as " << kind << "\n" << failures(report);
      const VerifyCheck design =
          check_design(directory.path(), read_manifest(directory.path()), outcome);
      ASSERT_TRUE(design.ok) << name << " as " << kind << ": " << design.detail;
      ++of_kind[kind];
      ++count;
    }
  }
  EXPECT_EQ(of_kind.size(), exporters().size()) << "a kind of export that this test leaves out";
}

// The degree to which the corruption is covered up.
enum class Cover {
  none,      // the manifest is not changed
  hash,      // also the hash of the file
  manifest,  // also the laws, weights and numbers of the file
  poles      // also the poles of these laws
};
constexpr Cover kCovers[] = {Cover::none, Cover::hash, Cover::manifest, Cover::poles};

// The start and end of each number in a text. Digits of names are excluded.
std::vector<std::pair<std::size_t, std::size_t>> numbers_in(const std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  const auto is_name = [&](std::size_t at) {
    return std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_';
  };
  for (std::size_t at = 0; at < text.size();) {
    if (std::isdigit(static_cast<unsigned char>(text[at])) == 0 || (at > 0 && is_name(at - 1))) {
      ++at;
      continue;
    }
    char* end = nullptr;
    (void)std::strtod(text.c_str() + at, &end);
    const auto stop = static_cast<std::size_t>(end - text.c_str());
    found.emplace_back(at, std::max(stop, at + 1));
    at = found.back().second;
  }
  return found;
}

std::size_t below(std::size_t end, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
}

std::string with_number(const std::string& text, Random& random,
                        const std::function<std::string(std::string)>& change) {
  const auto all = numbers_in(text);
  if (all.empty()) return text;
  const auto [first, last] = all[below(all.size(), random)];
  return text.substr(0, first) + change(text.substr(first, last - first)) + text.substr(last);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    lines.back() += c;
    if (c == '\n') lines.emplace_back();
  }
  return lines;
}

std::string joined_lines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

std::string scaled(const std::string& number, double factor) {
  return fmt::format("{}", std::strtod(number.c_str(), nullptr) * factor);
}

// One corruption of a file. `other` is the file with this name in the export of another design.
using Corruption = std::string (*)(const std::string& text, const std::string& other, Random&);
struct NamedCorruption {
  const char* name;
  Corruption change;
};

const NamedCorruption kKinds[] = {
    {"a flipped sign",
     [](const std::string& text, const std::string&, Random& random) {
       const auto all = numbers_in(text);
       if (all.empty()) return text;
       const std::size_t at = all[below(all.size(), random)].first;
       return at > 0 && text[at - 1] == '-' ? text.substr(0, at - 1) + text.substr(at)
                                            : text.substr(0, at) + "-" + text.substr(at);
     }},
    {"a rescaled number",
     [](const std::string& text, const std::string&, Random& random) {
       const double factor = std::uniform_real_distribution<double>(1.01, 3)(random);
       return with_number(text, random, [&](const std::string& n) { return scaled(n, factor); });
     }},
    {"a rescaled line",
     [](const std::string& text, const std::string&, Random& random) {
       std::vector<std::string> lines = lines_of(text);
       std::string& line = lines[below(lines.size(), random)];
       std::string changed;
       std::size_t at = 0;
       for (const auto& [first, last] : numbers_in(line)) {
         changed += line.substr(at, first - at) + scaled(line.substr(first, last - first), 1.1);
         at = last;
       }
       line = changed + line.substr(at);
       return joined_lines(lines);
     }},
    {"two swapped numbers",
     [](const std::string& text, const std::string&, Random& random) {
       const auto all = numbers_in(text);
       if (all.size() < 2) return text;
       const std::size_t i = below(all.size() - 1, random);
       const auto [a, b] = all[i];
       const auto [c, d] = all[i + 1];
       return text.substr(0, a) + text.substr(c, d - c) + text.substr(b, c - b) +
              text.substr(a, b - a) + text.substr(d);
     }},
    {"two swapped lines",
     [](const std::string& text, const std::string&, Random& random) {
       std::vector<std::string> lines = lines_of(text);
       if (lines.size() < 3) return text;
       const std::size_t i = below(lines.size() - 2, random);
       std::swap(lines[i], lines[i + 1]);
       return joined_lines(lines);
     }},
    {"a changed byte",
     [](const std::string& text, const std::string&, Random& random) {
       std::string changed = text;
       changed[below(changed.size(), random)] = static_cast<char>(' ' + below(95, random));
       return changed;
     }},
    {"a lost end", [](const std::string& text, const std::string&,
                      Random& random) { return text.substr(0, below(text.size(), random)); }},
    {"a file of another design",
     [](const std::string&, const std::string& other, Random&) { return other; }},
};

// A manifest that agrees with the changed files as far as a forger can achieve it.
Manifest forged(const TemporaryDirectory& directory, const Source& source, Cover cover) {
  const fs::path& path = directory.path();
  Manifest manifest = read_manifest(path);
  for (ManifestFile& file : manifest.files) {
    const std::string bytes = directory.read(file.path);
    file = {file.path, sha256(bytes), bytes.size()};
  }
  if (cover == Cover::hash) return manifest;
  const Exporter& exporter = exporter_of(manifest.kind, "test");
  if (exporter.numbers) {
    std::vector<NamedMatrix> numbers;
    for (const ManifestFile& file : manifest.files)
      for (NamedMatrix& number : exporter.numbers({file.path, directory.read(file.path)}))
        numbers.push_back(std::move(number));
    manifest.numbers = std::move(numbers);
  }
  const StoredLaws laws = exporter.read(path, manifest);
  if (manifest.gains && laws.gains) manifest.gains = laws.gains;
  if (manifest.cascade && laws.cascade) manifest.cascade = laws.cascade;
  if (fs::exists(path / kGainsJsonName)) {
    const auto json = nlohmann::json::parse(directory.read(kGainsJsonName));
    for (const auto& [key, M] : {std::pair("Q", &manifest.Q), std::pair("R", &manifest.R)})
      if (json.contains("weights"))
        for (Eigen::Index i = 0; i < M->rows(); ++i)
          for (Eigen::Index j = 0; j < M->cols(); ++j)
            (*M)(i, j) =
                json["weights"][key][static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  if (cover == Cover::manifest) return manifest;
  const ExportContent content = content_for(source.outcome, manifest.kind.name());
  if (manifest.gains && content.plant)
    manifest.closed_loop_poles = closed_loop_poles(*content.plant, *manifest.gains);
  if (manifest.cascade && content.cascade_plant)
    manifest.cascade_poles = closed_loop_poles(*content.cascade_plant, *manifest.cascade);
  return manifest;
}

// Whether two gains.json have the same vehicle, state feedback and weights, and the same loops of
// the cascade, unless `other_loops` is allowed.
bool same_but_cascade(const std::string& before, const std::string& after, bool other_loops) {
  const auto without = [&](const std::string& text) {
    auto json = nlohmann::json::parse(text);
    json.erase("estimator");
    json.erase("filters");
    if (other_loops) {
      json.erase("cascade");
    } else if (json.contains("cascade")) {
      const auto all = json["cascade"];
      json["cascade"] = {all["loops"], all["dt_s"], all["integrator"]};
    }
    return json;
  };
  return without(before) == without(after);
}

// Whether two files differ only in their comments.
bool same_numbers_in_m(const std::string& before, const std::string& after) {
  const auto numbers = [](const std::string& text) {
    std::ostringstream all;
    for (const NamedMatrix& number : parse_m_file(text, "test"))
      all << number.name << number.text << std::setprecision(17) << number.value;
    return all.str();
  };
  try {
    return numbers(before) == numbers(after);
  } catch (const InvalidInput&) {
    return false;
  }
}

// The same for two controllerVars.m.
bool same_but_cascade_in_m(const std::string& before, const std::string& after, bool other_loops) {
  const auto without = [&](const std::string& text) {
    std::vector<std::string> kept;
    for (const NamedMatrix& number : parse_m_file(text, "test")) {
      const bool cascade = number.name.starts_with("Controller.Cascade.");
      const bool gain = number.name.ends_with(".Kp") || number.name.ends_with(".Ki") ||
                        number.name.ends_with(".Kd") || number.name.ends_with(".Ts");
      if (cascade && (other_loops || !gain)) continue;
      std::ostringstream line;
      line << number.name << number.text << std::setprecision(17) << number.value;
      kept.push_back(line.str());
    }
    return kept;
  };
  return without(before) == without(after);
}

// Whether two manifests are equal except for versions, iterations, residual, condition, and poles
// in another order or within the tolerance of their comparison.
bool same_but_records(const std::string& before, const std::string& after) {
  const auto parsed = [](const std::string& text) -> std::optional<nlohmann::json> {
    auto json = nlohmann::json::parse(text, nullptr, false);
    if (json.is_discarded()) return {};
    json.erase("versions");
    for (const char* key : {"residual", "rcond", "iterations"}) json["evidence"].erase(key);
    for (const char* of : {"evidence", "closed_loop", "cascade_closed_loop"})
      if (json.contains(of) && json[of].contains("poles"))
        std::sort(json[of]["poles"].begin(), json[of]["poles"].end());
    return json;
  };
  const auto a = parsed(before), b = parsed(after);
  if (!a || !b) return false;
  if (*a == *b) return true;
  const auto apart = numbers_apart(a->dump(1), b->dump(1));
  const nlohmann::json difference = nlohmann::json::diff(*a, *b);
  return apart && std::all_of(difference.begin(), difference.end(), [&](const auto& change) {
           const std::string path = change["path"];
           const auto at = nlohmann::json::json_pointer(path);
           return path.find("poles") != std::string::npos && a->at(at).is_number() &&
                  b->at(at).is_number() &&
                  std::abs(a->at(at).template get<double>() - b->at(at).template get<double>()) <
                      1e-7;
         });
}

// Why a corruption cannot be detected without the design file; empty if it must be detected.
std::string undetectable(const std::string& kind, const std::string& file,
                         const std::string& before, const std::string& after, Cover cover) {
  if (file == kManifestName && same_but_records(before, after))
    return "versions and estimates of rounding errors are records, with which nothing else agrees; "
           "poles are compared to 1e-7, in any order";
  if (cover == Cover::none) return "";
  if (kind == "mambo" && file == "estimatorVars.m" &&
      (cover != Cover::hash || same_numbers_in_m(before, after)))
    return "the filters, gates and low passes are those of the design, and the comments name them";
  const bool is_firmware = export_target(kind, "test").is_firmware;
  if (is_firmware && file != kGainsJsonName) {
    const auto notes = [](const std::string& text) {
      std::string others;
      for (const std::string& line : lines_of(text))
        if (!line.starts_with("# Note: ")) others += line;
      return others;
    };
    if (notes(before) == notes(after)) return "a note mentions a cascade that is in no file";
  }
  if (cover == Cover::hash) return "";
  if (file.starts_with("kalman-")) return "covariances are those of the design";
  if (const auto apart = numbers_apart(before, after); apart && *apart < 1e-5)
    return "the loop is the same to five digits";
  const bool poles = cover == Cover::poles && !is_firmware;
  if (kind == "c") return "";  // each number is in the C as well
  if (file == kGainsJsonName && same_but_cascade(before, after, poles))
    return "estimator, filters and limits are those of the design, and where poles and manifest "
           "are "
           "forged as well, the cascade";
  if (file == "controllerVars.m" && same_but_cascade_in_m(before, after, poles))
    return "limits are those of the design, and where poles and manifest are forged as well, the "
           "cascade";
  return "";
}

struct Noticed {
  bool by_files = false;   // without the design
  bool by_design = false;  // with it
  std::string all;         // all details
};

Noticed seen(const TemporaryDirectory& directory, const Source& source) {
  Noticed result;
  try {
    const VerifyReport report = verified(directory.path(), source.outcome);
    result.by_files = !report.ok();
    result.all = failures(report);
    result.by_design =
        !check_design(directory.path(), read_manifest(directory.path()), source.outcome).ok;
  } catch (const InvalidInput& error) {
    result = {true, true, error.what()};
  } catch (const FileError& error) {
    result = {true, true, error.what()};
  }
  return result;
}

class Corrupted {
 public:
  Corrupted() {
    for (const char* name : {"uquad-hover", "mambo-hover", "quad-450", "crazyflie"}) {
      Random random(7);
      sources_.push_back({run_design(design_named(name)), kinds_of(name)});
      others_.push_back({run_design(varied(design_named(name), random)), kinds_of(name)});
    }
    for (std::size_t i = 0; i < sources_.size(); ++i)
      for (const std::string& kind : sources_[i].kinds)
        exports_.push_back({i, kind, written(sources_[i], kind), written(others_[i], kind)});
  }

  void corrupt(std::uint64_t seed) {
    Random random(seed);
    const Written& one = exports_[seed % exports_.size()];
    const Source& source = sources_[one.source];
    const NamedCorruption& corruption = kKinds[below(std::size(kKinds), random)];
    const Cover cover = kCovers[below(std::size(kCovers), random)];
    auto file = one.files.begin();
    std::advance(file, static_cast<std::ptrdiff_t>(below(one.files.size(), random)));
    const std::string& name = file->first;
    std::string changed = file->second;
    const auto other = one.other.find(name);
    for (int tries = 0; tries < 50 && changed == file->second; ++tries)
      changed =
          corruption.change(file->second, other == one.other.end() ? "" : other->second, random);
    if (changed == file->second) changed += " ";  // e.g. of another design, and the same
    const TemporaryDirectory directory;
    for (const auto& [path, bytes] : one.files)
      directory.write(path, path == name ? changed : bytes);
    const bool covered =
        cover != Cover::none && name != kManifestName && cover_up(directory, source, cover);
    const Noticed found = seen(directory, source);
    const std::string about =
        fmt::format("seed {}: {} in {} of {}, covered up to {}", seed, corruption.name, name,
                    one.kind, covered ? static_cast<int>(cover) : 0);
    const std::string reason =
        undetectable(one.kind, name, file->second, changed, covered ? cover : Cover::none);
    ++count_;
    if (!found.by_files) {
      EXPECT_NE(reason, "") << about << ": accepted, from line "
                            << first_other_line(file->second, changed);
      ++reasons_[reason];
    }
    const auto apart = numbers_apart(file->second, changed);
    const bool rounding = apart && *apart <= 1e-9;
    EXPECT_TRUE(found.by_design || found.by_files || rounding || name == kManifestName)
        << about << ": accepted with the design";
    if (!covered && name != kManifestName) {
      EXPECT_TRUE(found.by_files) << about << ": accepted";
    }
  }

  void remove_file(std::uint64_t seed) {
    Random random(seed);
    const Written& one = exports_[seed % exports_.size()];
    auto file = one.files.begin();
    std::advance(file, static_cast<std::ptrdiff_t>(below(one.files.size(), random)));
    const TemporaryDirectory directory;
    for (const auto& [path, bytes] : one.files)
      if (path != file->first) directory.write(path, bytes);
    EXPECT_TRUE(seen(directory, sources_[one.source]).by_files)
        << one.kind << " without " << file->first;
    ++count_;
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const std::map<std::string, int>& reasons() const { return reasons_; }

 private:
  struct Written {
    std::size_t source;
    std::string kind;
    Files files, other;
  };

  static Files written(const Source& source, const std::string& kind) {
    Files files;
    for (const FileContent& file :
         export_files(ExportKind(kind), content_for(source.outcome, kind)))
      files[file.name] = file.bytes;
    return files;
  }

  // False if the files can no longer be read: this cannot be covered up.
  static bool cover_up(const TemporaryDirectory& directory, const Source& source, Cover cover) {
    try {
      directory.write(kManifestName, manifest_text(forged(directory, source, cover)));
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }

  std::vector<Source> sources_, others_;
  std::vector<Written> exports_;
  std::map<std::string, int> reasons_;
  int count_ = 0;
};

TEST(ExportCorruptions, AreRejectedOrListed) {
  Corrupted corrupted;
  for (int seed = 0; seed < kCorruptions; ++seed) {
    if (seed % 9 == 8)
      corrupted.remove_file(static_cast<std::uint64_t>(seed));
    else
      corrupted.corrupt(static_cast<std::uint64_t>(seed));
  }
  EXPECT_EQ(corrupted.count(), kCorruptions);
  int listed = 0;
  for (const auto& [reason, count] : corrupted.reasons()) listed += count;
  if (!testing::kSanitized) {  // where there are too few to count
    EXPECT_LT(listed, kCorruptions / 5) << "the list excuses too much";
  }
}

}  // namespace
}  // namespace quadtune
