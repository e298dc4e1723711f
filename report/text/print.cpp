// SPDX-License-Identifier: Apache-2.0
#include "report/text/print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

constexpr std::size_t kHeadingWidth = 12;

std::string entry(double value, double scale) {
  return std::abs(value) <= 1e-13 * scale ? "0" : fmt::format("{:.6g}", value);
}

}  // namespace

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::vector<std::string> names_of(const std::vector<Signal>& signals) {
  return names_or_numbers(signals, std::ssize(signals));
}

std::string numbers(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + number(value);
  return text;
}

double decibels(double gain) { return 20 * std::log10(gain); }

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

std::string table(const Eigen::MatrixXd& M, const std::vector<std::string>& rows,
                  const std::vector<std::string>& columns) {
  Cells cells = {{""}};
  cells[0].insert(cells[0].end(), columns.begin(), columns.end());
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    const double scale = M.row(i).cwiseAbs().maxCoeff();
    cells.push_back({rows[static_cast<std::size_t>(i)]});
    for (const double value : M.row(i)) cells.back().push_back(entry(value, scale));
  }
  return aligned(cells);
}

std::string plain(const Eigen::MatrixXd& M) {
  std::vector<std::string> columns(static_cast<std::size_t>(M.cols()));
  const std::vector<std::string> rows(static_cast<std::size_t>(M.rows()));
  const std::string text = table(M, rows, columns);
  return text.substr(text.find('\n') + 1);  // no header line
}

double stability_measure(const Eigen::VectorXcd& poles, double dt) {
  return dt > 0 ? poles.cwiseAbs().maxCoeff() : poles.real().maxCoeff();
}

std::string pole_table(const Eigen::VectorXcd& poles, double dt) {
  struct Row {
    std::complex<double> pole;
    std::complex<double> s;  // the continuous pole of the same mode
  };
  std::vector<Row> rows;
  for (Eigen::Index i = 0; i < poles.size(); ++i) {
    const std::complex<double> pole = poles(i);
    if (pole.imag() < 0) continue;  // one row represents both conjugates
    rows.push_back({pole, dt > 0 ? std::log(pole) / dt : pole});
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return a.s.real() != b.s.real() ? a.s.real() > b.s.real() : a.s.imag() < b.s.imag();
  });
  Cells cells = {{dt > 0 ? "pole z" : "pole [1/s]", "wn [rad/s]", "damping", "time const [s]"}};
  for (const Row& row : rows) {
    const std::string pole =
        row.pole.imag() > 0 ? fmt::format("{:.6g} +- {:.6g}i", row.pole.real(), row.pole.imag())
                            : fmt::format("{:.6g}", row.pole.real());
    const double wn = std::abs(row.s);
    if (std::isinf(wn)) {  // z = 0: decays within one sample, has no frequency
      cells.push_back({pole, "-", "-", "0"});
      continue;
    }
    const double time = row.s.real() == 0 ? std::numeric_limits<double>::infinity()  // of either 0
                                          : -1 / row.s.real();
    cells.push_back({pole, fmt::format("{:.4g}", wn),
                     fmt::format("{:.3f}", wn > 0 ? -row.s.real() / wn : 0.0),
                     fmt::format("{:.4g}", time)});
  }
  return aligned(cells);
}

std::string section(const std::string& heading, const std::string& text) {
  std::string result = fmt::format("{:<{}}", heading, kHeadingWidth);
  if (heading.size() >= kHeadingWidth) result = heading + "\n" + std::string(kHeadingWidth, ' ');
  for (const char c : text) {
    result += c;
    if (c == '\n') result += std::string(kHeadingWidth, ' ');
  }
  return result + "\n";
}

}  // namespace quadtune::report
