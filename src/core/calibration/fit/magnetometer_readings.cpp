#include "calibration/fit/magnetometer_readings.hpp"

#include "calibration/fit/error.hpp"
#include <sonopose/statistics/quantile.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace sonopose::calibration::fit::detail {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using statistics::quantile;

constexpr std::size_t min_samples = 50;

std::vector<double> axis_of(const Points& points, Index axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Vector3d& point : points) values.push_back(point[axis]);
  return values;
}

Vector3d median_of(const Points& points) {
  return {quantile(axis_of(points, 0), 0.5), quantile(axis_of(points, 1), 0.5),
          quantile(axis_of(points, 2), 0.5)};
}

}  // namespace

Points fields_of(std::span<const ImuSample> imu) {
  constexpr double microtesla_per_tesla = 1e6;
  Points fields_ut;
  for (const ImuSample& sample : imu) {
    if (!sample.magnetic_field_body_t) continue;
    const Vector3d field_ut = microtesla_per_tesla * *sample.magnetic_field_body_t;
    if (field_ut.allFinite()) fields_ut.push_back(field_ut);
  }
  if (fields_ut.size() < min_samples) {
    throw CalibrationError(std::to_string(fields_ut.size()) + " samples have a magnetic field; " +
                           std::to_string(min_samples) + " are needed");
  }
  return fields_ut;
}

Span span_of(const Points& points_ut) {
  Span found;
  for (Index axis = 0; axis < 3; ++axis) {
    const std::vector<double> values_ut = axis_of(points_ut, axis);
    // Halved first, because the sum of two huge numbers may overflow.
    const double half_of_low_ut = 0.5 * quantile(values_ut, 0.01);
    const double half_of_high_ut = 0.5 * quantile(values_ut, 0.99);
    found.middle_ut[axis] = half_of_low_ut + half_of_high_ut;
    found.half_ut = std::max(found.half_ut, half_of_high_ut - half_of_low_ut);
  }
  if (!(found.half_ut > 0.0)) throw CalibrationError("the magnetic field is the same in every sample");
  return found;
}

Points thinned(const Points& points_ut, const Span& span) {
  constexpr int max_per_cell = 5;
  constexpr double cell = 0.1;
  constexpr double max_cell_index = 1e9;  // in cells: anything beyond still has a whole number
  std::map<std::array<std::int64_t, 3>, int> seen;
  Points kept;
  for (const Vector3d& point_ut : points_ut) {
    const Vector3d point = (point_ut - span.middle_ut) / span.half_ut;
    std::array<std::int64_t, 3> key{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double place = std::floor(point[static_cast<Index>(i)] / cell);
      key[i] = static_cast<std::int64_t>(std::clamp(place, -max_cell_index, max_cell_index));
    }
    if (seen[key]++ < max_per_cell) kept.push_back(point);
  }
  return kept;
}

Points without_glitches(const Points& points_ut) {
  // Even on a long ellipsoid the farthest point is only about twice as far from the middle as the median one.
  constexpr double farthest_in_medians = 3.0;
  const Span span = span_of(points_ut);
  // Span of the thinned readings: a long rest would otherwise make all others glitches.
  const Points thin = thinned(points_ut, span);
  const Vector3d middle = median_of(thin);
  std::vector<double> distances;
  for (const Vector3d& point : thin) distances.push_back((point - middle).norm());
  const double limit = farthest_in_medians * quantile(std::move(distances), 0.5);
  Points kept_ut;
  for (const Vector3d& point_ut : points_ut) {
    const double distance = ((point_ut - span.middle_ut) / span.half_ut - middle).norm();
    if (distance <= limit) kept_ut.push_back(point_ut);
  }
  return kept_ut;
}

/// Share of 48 equal parts of the sphere that contain a corrected reading.
double coverage_of(const Points& points, const VectorXd& parameters) {
  constexpr int bands = 6;
  constexpr int sectors = 8;
  std::array<std::array<bool, sectors>, bands> seen{};
  for (const Vector3d& point : points) {
    const Vector3d d = (soft_iron_of(parameters) * point - parameters.tail<3>()).normalized();
    const double turn = (std::atan2(d.y(), d.x()) + std::numbers::pi) / (2.0 * std::numbers::pi);
    const int band = std::clamp(static_cast<int>(0.5 * (d.z() + 1.0) * bands), 0, bands - 1);
    const int sector = std::clamp(static_cast<int>(turn * sectors), 0, sectors - 1);
    seen[static_cast<std::size_t>(band)][static_cast<std::size_t>(sector)] = true;
  }
  std::ptrdiff_t count = 0;
  for (const auto& band : seen) count += std::count(band.begin(), band.end(), true);
  return static_cast<double>(count) / (bands * sectors);
}

}  // namespace sonopose::calibration::fit::detail
