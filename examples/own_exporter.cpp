// SPDX-License-Identifier: Apache-2.0
/// An export for a flight program of your own, written and read back: own_exporter DIRECTORY
/// Exit status: 0 if every check of the files passes, 1 if not, 2 and one line for any error.
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <quadtune/quadtune.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace {

/// The files of the flight program: here one, with the gains as rows of numbers.
std::vector<quadtune::FileContent> rows_of(const quadtune::ExportContent& content) {
  std::ostringstream text;
  text << "# u = u0 + K (x_sp - x)\n" << std::setprecision(17);  // every digit of a double
  for (const auto& row : content.gains->K.rowwise()) text << row << '\n';
  return {{"K.txt", text.str()}};
}

/// What the flight program reads from them. All that the files do not hold is in the manifest.
quadtune::StoredLaws laws_of(const std::filesystem::path& directory,
                             const quadtune::Manifest& manifest) {
  quadtune::StoredLaws laws{manifest.vehicle, *manifest.gains, {}};
  laws.gains->K = quadtune::read_text_matrix((directory / "K.txt").string());
  return laws;
}

}  // namespace

int main(int count, char** words) {
  try {
    if (count < 2) throw std::runtime_error("where? own_exporter DIRECTORY");
    quadtune::Exporter mine;
    mine.target = {.name = "mine", .needs_gains = true};
    mine.convention = "ned";
    mine.gain_files = {"K.txt"};
    mine.writes_cascade = false;
    mine.files = rows_of;
    mine.read = laws_of;
    quadtune::add_exporter(mine);  // design files know the name from now on
    const quadtune::Vehicle vehicle = quadtune::load_vehicle("mambo");
    quadtune::DesignRequirements requirements;
    requirements.lqr = quadtune::usual_lqr(vehicle);
    const quadtune::ExportContent content =
        quadtune::export_content(quadtune::design(vehicle, requirements));
    for (const quadtune::ManifestFile& file :
         quadtune::write_export(words[1], quadtune::ExportKind("mine"), content))
      std::cout << "written: " << file.path << '\n';
    // Hashes, numbers, trim and poles, for this exporter as for every other.
    const quadtune::VerifyReport report = quadtune::verify_with(words[1], vehicle, {});
    for (const quadtune::VerifyCheck& check : report.checks)
      std::cout << (check.ok ? "pass: " : "FAIL: ") << check.name << '\n';
    return report.ok() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "own_exporter: " << error.what() << '\n';
    return 2;
  }
}
