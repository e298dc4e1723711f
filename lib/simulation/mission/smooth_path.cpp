// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/smooth_path.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"
#include "simulation/loop/bounds.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;

// The parameter s and its time derivatives.
struct Progress {
  double s = 0;
  double rate = 0;
  double acceleration = 0;
};

// Full rate and total length of each path's parameter.
struct Extent {
  double rate;
  double total;
};
Extent extent(const LinePath& path) { return {path.speed, (path.to - path.from).norm()}; }
Extent extent(const CirclePath& path) {
  return {path.speed / std::abs(path.radius), 2 * std::numbers::pi * path.turns};
}
Extent extent(const LemniscatePath& path) {
  return {2 * std::numbers::pi / path.lap, 2 * std::numbers::pi * path.laps};
}

// Each ramp covers half of the distance at full rate, so both together add the duration of one.
double travel_time(const Extent& way, double ramp) { return way.total / way.rate + ramp; }

// Acceleration phase, at time t after its beginning, at most `ramp`.
Progress while_gathering(double rate, double ramp, double t) {
  const double u = t / ramp;
  const double u2 = u * u;
  return {rate * ramp * u2 * u2 * (u2 - 3 * u + 2.5),  // integral of the next line
          rate * u2 * u * (6 * u2 - 15 * u + 10),      // 6 u⁵ - 15 u⁴ + 10 u³
          rate / ramp * 30 * u2 * (u2 - 2 * u + 1)};   // 30 u⁴ - 60 u³ + 30 u²
}

Progress progress(const Extent& way, const Passage& passage, double t) {
  const double since = t - passage.begin;
  if (!(since > 0)) return {};
  const double left = travel_time(way, passage.ramp) - since;
  if (left <= 0) return {way.total, 0, 0};
  if (since < passage.ramp) return while_gathering(way.rate, passage.ramp, since);
  if (left < passage.ramp) {
    const Progress mirrored = while_gathering(way.rate, passage.ramp, left);
    return {way.total - mirrored.s, mirrored.rate, -mirrored.acceleration};
  }
  return {way.rate * (since - passage.ramp / 2), way.rate, 0};
}

// Position and its first two derivatives with respect to s.
struct CurvePoint {
  Vector3d p, dp, ddp;
};

// Direction of the curve [rad] and its derivative with respect to s.
struct Heading {
  double angle;
  double by_s;
};

CurvePoint curve(const LinePath& path, double s) {
  const Vector3d along = (path.to - path.from).normalized();
  return {path.from + along * s, along, Vector3d::Zero()};
}

Heading heading(const LinePath& path, double /*s*/) {
  const Vector3d way = path.to - path.from;
  return {std::atan2(way.y(), way.x()), 0};
}

double sense(const CirclePath& path) { return path.radius > 0 ? 1 : -1; }

CurvePoint curve(const CirclePath& path, double s) {
  const double radius = std::abs(path.radius);
  const double bearing = path.bearing + sense(path) * s;
  const Vector3d outward(std::cos(bearing), std::sin(bearing), 0);
  const Vector3d sideways(-outward.y(), outward.x(), 0);  // d outward / d bearing
  return {path.center + radius * outward, path.radius * sideways, -radius * outward};
}

Heading heading(const CirclePath& path, double s) {
  return {path.bearing + sense(path) * (s + std::numbers::pi / 2), sense(path)};
}

CurvePoint curve(const LemniscatePath& path, double s) {
  const double a = path.length / 2, b = path.width / 2;
  const Vector3d along(std::cos(path.heading), std::sin(path.heading), 0);
  const Vector3d right(-along.y(), along.x(), 0);
  const double sin1 = std::sin(s), cos1 = std::cos(s);
  const double sin2 = 2 * sin1 * cos1, cos2 = cos1 * cos1 - sin1 * sin1;
  return {path.center + a * sin1 * along + b * sin2 * right,
          a * cos1 * along + 2 * b * cos2 * right, -a * sin1 * along - 4 * b * sin2 * right};
}

Heading heading(const LemniscatePath& path, double s) {
  const double a = path.length / 2, b = path.width / 2;
  const double dx = a * std::cos(s), dy = 2 * b * std::cos(2 * s);
  const double ddx = -a * std::sin(s), ddy = -4 * b * std::sin(2 * s);
  // The tangent points exactly to the left at the tips and never exactly to the right, so an angle
  // measured from the left is continuous.
  return {path.heading - std::numbers::pi / 2 + std::atan2(dx, -dy),
          (dx * ddy - dy * ddx) / (dx * dx + dy * dy)};
}

void require(bool holds, const std::string& where, const std::string& message) {
  if (!holds) throw InvalidInput(where, message);
}

void validate_shape(const LinePath& path, const std::string& where) {
  internal::require_place(path.from, where, "the line's first point");
  internal::require_place(path.to, where, "the line's last point");
  internal::require_within(path.speed, internal::kSpeeds, where, "speed", "m/s");
  require((path.to - path.from).norm() > internal::kMinWay, where,
          "the line's first and last points are the same, expected different points");
  require(path.passage.nose == Nose::fixed ||
              (path.to - path.from).head<2>().norm() > internal::kMinWay,
          where, "the line is vertical, expected a fixed nose because the line has no heading");
}

void validate_shape(const CirclePath& path, const std::string& where) {
  internal::require_place(path.center, where, "the circle's centre");
  internal::require_within(std::abs(path.radius), internal::kSizes, where, "radius", "m");
  internal::require_within(path.bearing, internal::kAngles, where, "bearing", "rad");
  internal::require_within(path.speed, internal::kSpeeds, where, "speed", "m/s");
  internal::require_within(path.turns, internal::kCounts, where, "number of turns", "");
}

void validate_shape(const LemniscatePath& path, const std::string& where) {
  internal::require_place(path.center, where, "the lemniscate's centre");
  internal::require_within(path.length, internal::kSizes, where, "length", "m");
  internal::require_within(path.width, internal::kSizes, where, "width", "m");
  internal::require_within(path.heading, internal::kAngles, where, "heading", "rad");
  internal::require_within(path.lap, internal::kDurations, where, "time of a lap", "s");
  internal::require_within(path.laps, internal::kCounts, where, "number of laps", "");
}

}  // namespace

PathPoint path_point(const SmoothPath& path, double t) {
  return std::visit(
      [t](const auto& shape) {
        const Progress at = progress(extent(shape), shape.passage, t);
        const CurvePoint c = curve(shape, at.s);
        PathPoint point;
        point.position = c.p;
        point.velocity = c.dp * at.rate;
        point.acceleration = c.ddp * (at.rate * at.rate) + c.dp * at.acceleration;
        point.yaw = shape.passage.yaw;
        if (shape.passage.nose == Nose::ahead) {
          const Heading way = heading(shape, at.s);
          point.yaw = way.angle;
          point.yaw_rate = way.by_s * at.rate;
        }
        return point;
      },
      path);
}

double path_end(const SmoothPath& path) {
  return std::visit(
      [](const auto& shape) {
        return shape.passage.begin + travel_time(extent(shape), shape.passage.ramp);
      },
      path);
}

void validate(const SmoothPath& path, const std::string& where) {
  std::visit(
      [&](const auto& shape) {
        const Passage& passage = shape.passage;
        internal::require_within(passage.begin, internal::kTimes, where, "begin", "s");
        internal::require_within(passage.ramp, internal::kDurations, where, "ramp", "s");
        internal::require_within(passage.yaw, internal::kAngles, where, "yaw", "rad");
        validate_shape(shape, where);
        const Extent way = extent(shape);
        const double cruise = way.total / way.rate;
        require(cruise >= passage.ramp, where,
                fmt::format("the path takes {:.6g} s at full speed, which is less than its ramp "
                            "of {:.6g} s, expected a longer path, a lower speed or a shorter ramp",
                            cruise, passage.ramp));
      },
      path);
}

}  // namespace quadtune
