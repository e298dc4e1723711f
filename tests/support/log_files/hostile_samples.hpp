// SPDX-License-Identifier: Apache-2.0
/// Small generated logs of each format, to be truncated and damaged; also the seeds of the fuzz
/// targets.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <vector>

#include "log_files/mat_writer.hpp"
#include "log_files/sample_logs.hpp"
#include "log_files/ulog_writer.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune::testing {

struct LogSample {
  std::string name;
  std::string format;  ///< as LogOptions has it
  std::string bytes;
  std::vector<std::size_t> borders;  ///< where records end
};

inline LogSample text_sample(const std::string& name, const std::string& format,
                             const std::string& bytes) {
  LogSample sample{name, format, bytes, {}};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    if (bytes[i] == '\n') sample.borders.push_back(i + 1);
  return sample;
}

/// A log for each reader except that of MAT files.
inline std::vector<LogSample> log_samples() {
  const std::string readings = "1 2 3 4 5 6 7 8 9 288 100947\n";
  std::string frames;
  std::string program;
  std::string replay;
  for (int k = 0; k < 6; ++k) {
    const int n = 10000 + 7 * k;
    frames += fmt::format("A\t{}\t1\t0\t208\t-30\t-27\t-4\t124\t-33\t151\t288\t100947\tZ\n", n);
    program += fmt::format("5 {}0 {}", n, readings);
    replay += fmt::format("{0},imu,1.5,-2e-3,3,4,5,{1}\r\n{0},baro,487.6\r\n", n, k);
  }
  std::vector<LogSample> samples = {
      text_sample("csv", "text",
                  "#timestamp [ns],w_x [rad s^-1],mode,\"q[0]\"\n1403715273262142976,0.5,AUTO,1\n"
                  "1403715273267142912,-.5e-3,,nan\n1403715273272142976,+7,MANUAL,inf\n"),
      text_sample("blanks", "text", "0002 919348 0.01 1500\n0002 972755 -0.01 1500\n"),
      text_sample("semicolons", "text", "t;x[m]\r\n0;1\r\n1;2;3\r\n2;3\r\n"),
      text_sample("replay", "replay", replay),
      text_sample("frames", "uquad-frames", frames),
      text_sample("program", "uquad-log", program)};
  const UlogWriter ulog = sample_ulog();
  samples.push_back({"ulog", "ulog", ulog.bytes(), ulog.borders()});
  return samples;
}

/// MAT files of other programs and of quadtune.
inline std::vector<LogSample> mat_samples() {
  std::vector<LogSample> samples;
  for (const bool compressed : {false, true}) {
    MatWriter mat(compressed, compressed);
    std::vector<std::size_t> borders = {mat.bytes().size()};
    mat.matrix("t", {1, 4}, {0, 0.1, 0.2, 0.3});
    borders.push_back(mat.bytes().size());
    mat.matrix("z", {4, 2}, {1, 2, 3, 4, 5, 6, 7, 8});
    borders.push_back(mat.bytes().size());
    mat.simulink("yout", {0, 1}, {{"motors", {2, 2}, {1, 2, 3, 4}}, {"flag", {2, 1}, {0, 1}}});
    borders.push_back(mat.bytes().size());
    samples.push_back({compressed ? "mat-v7" : "mat-v6", "mat", mat.bytes(), borders});
  }
  const std::string own = bytes_of_mat(small_log());
  samples.push_back({"mat-flight", "mat", own, {128, own.size()}});
  return samples;
}

}  // namespace quadtune::testing
