// SPDX-License-Identifier: Apache-2.0
#include "report/text/print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

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
  std::size_t name_width = 0;
  for (const std::string& row : rows) name_width = std::max(name_width, row.size());
  std::vector<std::size_t> widths;
  widths.reserve(columns.size());
  for (const std::string& column : columns) widths.push_back(column.size());
  std::vector<std::vector<std::string>> cells;
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    const double scale = M.row(i).cwiseAbs().maxCoeff();
    cells.emplace_back();
    for (Eigen::Index j = 0; j < M.cols(); ++j) {
      cells.back().push_back(entry(M(i, j), scale));
      std::size_t& width = widths[static_cast<std::size_t>(j)];
      width = std::max(width, cells.back().back().size());
    }
  }
  std::string text = fmt::format("{:<{}}", "", name_width);
  for (std::size_t j = 0; j < columns.size(); ++j)
    text += fmt::format("  {:>{}}", columns[j], widths[j]);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += fmt::format("\n{:<{}}", rows[i], name_width);
    for (std::size_t j = 0; j < columns.size(); ++j)
      text += fmt::format("  {:>{}}", cells[i][j], widths[j]);
  }
  return text;
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
    if (pole.imag() < 0) continue;  // its conjugate stands for both
    rows.push_back({pole, dt > 0 ? std::log(pole) / dt : pole});
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return a.s.real() != b.s.real() ? a.s.real() > b.s.real() : a.s.imag() < b.s.imag();
  });
  std::string text = fmt::format("{:<24}{:>12}{:>10}{:>16}", dt > 0 ? "pole z" : "pole [1/s]",
                                 "wn [rad/s]", "damping", "time const [s]");
  for (const Row& row : rows) {
    const std::string pole =
        row.pole.imag() > 0 ? fmt::format("{:.6g} +- {:.6g}i", row.pole.real(), row.pole.imag())
                            : fmt::format("{:.6g}", row.pole.real());
    const double wn = std::abs(row.s);
    if (std::isinf(wn)) {  // z = 0: over within a sample, without a frequency
      text += fmt::format("\n{:<24}{:>12}{:>10}{:>16}", pole, "-", "-", "0");
      continue;
    }
    const double time = row.s.real() == 0 ? std::numeric_limits<double>::infinity()  // of either 0
                                          : -1 / row.s.real();
    text += fmt::format("\n{:<24}{:>12.4g}{:>10.3f}{:>16.4g}", pole, wn,
                        wn > 0 ? -row.s.real() / wn : 0.0, time);
  }
  return text;
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
