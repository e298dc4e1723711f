// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/uquad.hpp"

namespace quadtune::exports {
namespace {

namespace fs = std::filesystem;

constexpr char kKalmanQ[] = "kalman-Q.txt", kKalmanR[] = "kalman-R.txt";

std::vector<FileContent> files_of(const ExportContent& content) {
  if (!content.gains)
    throw InvalidInput(
        "uquad",
        "there is no state feedback, expected gains of one, e.g. from a design file with [lqr]");
  std::vector<FileContent> files =
      uquad_files(*content.gains, content.Q, content.R, content.uquad_filter);
  if (content.imu_calibration)
    files.push_back({kImuCalibrationName, imu_calibration_text(*content.imu_calibration)});
  if (content.uquad_constants)
    files.push_back(
        {kUquadConstantsName, uquad_constants_text(content.vehicle, content.gains->dt)});
  return files;
}

bool lists(const Manifest& manifest, const char* name) {
  return std::any_of(manifest.files.begin(), manifest.files.end(),
                     [name](const ManifestFile& file) { return file.path == name; });
}

std::vector<std::string> gain_files() {
  std::vector<std::string> all = {"lqr-Q.txt", "lqr-R.txt",         kKalmanQ,
                                  kKalmanR,    kImuCalibrationName, kUquadConstantsName};
  for (const UquadFileSet& set : uquad_file_sets()) {
    all.push_back(set.proportional);
    if (!set.integral.empty()) all.push_back(set.integral);
  }
  return all;
}

// A uquad directory may contain files of other builds that the manifest does not list.
fs::path listed_uquad_file(const fs::path& directory, const Manifest& manifest) {
  for (const UquadFileSet& set : uquad_file_sets())
    for (const ManifestFile& file : manifest.files)
      if (file.path == set.proportional) return directory / file.path;
  throw InvalidInput((directory / kManifestName).string(), "lists no gain file of uquad");
}

StoredLaws read(const fs::path& directory, const Manifest& manifest) {
  StoredLaws laws{manifest.vehicle, read_uquad_gains(listed_uquad_file(directory, manifest)), {}};
  Gains& gains = *laws.gains;
  gains.vehicle = manifest.vehicle;
  if (!manifest.gains) return laws;
  // Data that the files do not contain; columns are compared by name, so their order may differ.
  gains.dt = manifest.gains->dt;
  gains.sign_law = manifest.gains->sign_law;
  gains.u0 = manifest.gains->u0;
  for (std::size_t i = 0; i < gains.states.size(); ++i)
    for (std::size_t j = 0; j < manifest.gains->states.size(); ++j)
      if (gains.states[i].name == manifest.gains->states[j].name)
        gains.x0(static_cast<Eigen::Index>(i)) = manifest.gains->x0(static_cast<Eigen::Index>(j));
  return laws;
}

// Reads a folder with a gain file, or a file by its name. A file of numbers with another name is
// rejected with the names that are accepted.
std::optional<StoredLaws> read_plain(const fs::path& path) {
  const bool is_directory = fs::is_directory(path);
  const auto is_in_it = [&](const UquadFileSet& set) {
    return fs::exists(path / set.proportional);
  };
  const auto is_uquad_name = [name = path.filename().string()](const UquadFileSet& set) {
    return name == set.proportional || (!set.integral.empty() && name == set.integral);
  };
  const std::vector<UquadFileSet>& sets = uquad_file_sets();
  if (is_directory && std::none_of(sets.begin(), sets.end(), is_in_it)) return {};
  if (!is_directory && std::none_of(sets.begin(), sets.end(), is_uquad_name)) {
    const char mark = first_mark(export_text(path));
    if (std::isdigit(static_cast<unsigned char>(mark)) == 0 && mark != '-' && mark != '+')
      return {};
  }
  return StoredLaws{"", read_uquad_gains(path), {}};
}

Eigen::RowVectorXd diagonal_of(const std::string& name, const std::string& text,
                               const std::string& origin) {
  const bool is_Q = name == kKalmanQ;
  Eigen::RowVectorXd variances = parse_uquad_matrix(text, 1, is_Q ? 15 : 16, origin);
  if (is_Q ? variances.minCoeff() < 0 : !(variances.minCoeff() > 0))
    throw InvalidInput(origin,
                       fmt::format("has a variance of {:g}, expected {}", variances.minCoeff(),
                                   is_Q ? "0 or more" : "more than 0"));
  return variances;
}

// The filter's diagonals next to uquad's gains; no value if the manifest lists none.
std::optional<UquadDiagonals> read_diagonals(const fs::path& directory, const Manifest& manifest) {
  UquadDiagonals diagonals;
  for (const ManifestFile& file : manifest.files) {
    if (file.path != kKalmanQ && file.path != kKalmanR) continue;
    const fs::path path = directory / file.path;
    (file.path == kKalmanQ ? diagonals.Q : diagonals.R) =
        diagonal_of(file.path, export_text(path), path.string());
  }
  if (diagonals.Q.size() == 0 && diagonals.R.size() == 0) return {};
  if (diagonals.Q.size() == 0 || diagonals.R.size() == 0)
    throw InvalidInput(
        (directory / kManifestName).string(),
        fmt::format("lists only one of {} and {}; expected both or none", kKalmanQ, kKalmanR));
  return diagonals;
}

// The manifest contains gains and weights, but not the filter's diagonals.
std::vector<NamedMatrix> numbers(const FileContent& file) {
  const std::string name = fs::path(file.name).filename().string();
  if (name != kKalmanQ && name != kKalmanR) return {};
  return {{file.name, "variances", diagonal_of(name, file.bytes, file.name), ""}};
}

std::vector<FileContent> written_again(const fs::path& directory, const Manifest& manifest,
                                       const Vehicle& vehicle) {
  if (!manifest.gains) return {};
  ExportContent content;
  content.vehicle = vehicle;
  content.uquad_constants = lists(manifest, kUquadConstantsName);
  content.gains = manifest.gains;
  content.Q = manifest.Q;
  content.R = manifest.R;
  content.uquad_filter = read_diagonals(directory, manifest);
  if (lists(manifest, kImuCalibrationName))
    content.imu_calibration = read_imu_calibration((directory / kImuCalibrationName).string());
  return files_of(content);
}

// Reads the weights next to uquad's gains, in the same plain format.
void read_weights(const fs::path& directory, const Manifest& manifest, const Gains& gains) {
  const auto n = static_cast<Eigen::Index>(gains.states.size() + gains.integrals.size());
  const auto nu = static_cast<Eigen::Index>(gains.inputs.size());
  for (const ManifestFile& file : manifest.files) {
    const bool is_Q = file.path == "lqr-Q.txt";
    if (!is_Q && file.path != "lqr-R.txt") continue;
    const fs::path path = directory / file.path;
    (void)parse_uquad_matrix(export_text(path), is_Q ? n : nu, is_Q ? n : nu, path.string());
  }
}

void check(const fs::path& directory, const Manifest& manifest, const Gains& gains) {
  (void)uquad_file_set(gains);  // rejects a trim that the flight program does not support
  read_weights(directory, manifest, gains);
  (void)read_diagonals(directory, manifest);
  if (lists(manifest, kImuCalibrationName))
    (void)read_imu_calibration((directory / kImuCalibrationName).string());
}

bool same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

// The difference between lqr-Q.txt and lqr-R.txt and the manifest's weights in their order, or "".
std::string weights_difference(const fs::path& directory, const Manifest& manifest) {
  const auto is_weights = [](const std::string& name) { return name.starts_with("lqr-"); };
  std::ptrdiff_t left = std::count_if(manifest.files.begin(), manifest.files.end(),
                                      [&](const ManifestFile& f) { return is_weights(f.path); });
  for (const FileContent& file : uquad_files(*manifest.gains, manifest.Q, manifest.R)) {
    if (!is_weights(file.name)) continue;
    --left;
    const Eigen::Index n = file.name == "lqr-Q.txt" ? manifest.Q.rows() : manifest.R.rows();
    const fs::path path = directory / file.name;
    if (!same(parse_uquad_matrix(export_text(path), n, n, path.string()),
              parse_uquad_matrix(file.bytes, n, n, file.name)))
      return file.name + " differs";
  }
  return left == 0 ? "" : "the manifest lists weight files, but lacks some of their weights";
}

}  // namespace

Exporter uquad_exporter() {
  Exporter exporter;
  exporter.target = export_target("uquad", "exporter");
  exporter.convention = "uquad";
  exporter.gain_files = gain_files();
  exporter.writes_cascade = false;
  exporter.files = files_of;
  exporter.read = read;
  exporter.read_plain = read_plain;
  exporter.check = check;
  exporter.weights_difference = weights_difference;
  exporter.numbers = numbers;
  exporter.written_again = written_again;
  return exporter;
}

}  // namespace quadtune::exports
