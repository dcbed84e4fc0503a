#include "doctor/probe/longest_rest.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <vector>

namespace sonopose::doctor::probe {
namespace {

// Limits at rest: above the spread of a noisy sensor, below that of a moving vehicle.
constexpr double rest_force_std_mps2 = 0.25;
constexpr double rest_rate_std_radps = 0.03;
constexpr double rest_fixes_span_m = 0.25;
/// Limit of a constant rotation, above the offset of any gyroscope.
constexpr double rotation_radps = 10.0 * geometry::radians_per_degree;

constexpr TimeNs block_ns = 1'000'000'000;
/// Samples in half a second of the slowest IMU; fewer are not significant.
constexpr double min_samples = 10;
constexpr std::size_t min_blocks = 3;

using Readings = Eigen::Matrix<double, 6, 1>;  ///< specific force, angular velocity

/// Sums of the readings.
struct Sums {
  double count = 0;
  Readings sum = Readings::Zero();
  Readings squares = Readings::Zero();

  void add(const ImuSample& imu) {
    Readings all;
    all << imu.specific_force_body_mps2, imu.angular_velocity_body_radps;
    ++count;
    sum += all;
    squares += all.cwiseAbs2();
  }
  void add(const Sums& others) {
    count += others.count;
    sum += others.sum;
    squares += others.squares;
  }
  [[nodiscard]] Readings mean() const { return sum / count; }
  [[nodiscard]] bool is_still() const {
    if (count < min_samples) return false;
    const Readings variance = squares / count - mean().cwiseAbs2();
    // Comparisons with NaN are false, but the maximum of several numbers may hide a NaN.
    if (!variance.allFinite()) return false;
    return mean().tail<3>().norm() < rotation_radps &&
           variance.head<3>().maxCoeff() < rest_force_std_mps2 * rest_force_std_mps2 &&
           variance.tail<3>().maxCoeff() < rest_rate_std_radps * rest_rate_std_radps;
  }
};

struct Block {
  Sums readings;
  std::array<std::vector<double>, 3> fixes_m;  ///< by axis

  /// The median of the fixes: up to half of them can be outliers.
  [[nodiscard]] Vector3d median_m() const {
    Vector3d median;
    for (std::size_t axis = 0; axis < fixes_m.size(); ++axis) {
      std::vector<double> values = fixes_m.at(axis);
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      median(static_cast<Eigen::Index>(axis)) = *middle;
    }
    return median;
  }
};

std::vector<Block> blocks_of(const Latest<ImuSample>& readings, const Latest<UltrasonicFix>& fixes) {
  const TimeNs begin_ns = readings.entries().front().received_ns;
  const TimeNs end_ns = std::max(begin_ns, readings.entries().back().received_ns);
  std::vector<Block> blocks(static_cast<std::size_t>((end_ns - begin_ns) / block_ns) + 1);
  const auto block_at = [&](TimeNs time_ns) -> Block& {
    return blocks.at(static_cast<std::size_t>((time_ns - begin_ns) / block_ns));
  };
  for (const auto& [received_ns, imu] : readings.entries()) {
    if (received_ns >= begin_ns && received_ns <= end_ns) block_at(received_ns).readings.add(imu);
  }
  for (const auto& [received_ns, fix] : fixes.entries()) {
    if (received_ns < begin_ns || received_ns > end_ns || !fix.position_world_m.allFinite()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block_at(received_ns).fixes_m.at(axis).push_back(fix.position_world_m(static_cast<Eigen::Index>(axis)));
    }
  }
  // Drop a last block that is too short.
  if (blocks.size() > 1 && blocks.back().readings.count < min_samples) blocks.pop_back();
  return blocks;
}

/// Consecutive blocks in which the beacon rests.
struct Rest {
  std::size_t blocks = 0;
  Sums readings;
  Eigen::AlignedBox3d fixes_m;

  /// Adds a block. Returns false, without a change, if the beacon does not rest in it.
  bool extend(const Block& block) {
    Sums all = readings;
    all.add(block.readings);
    if (!block.readings.is_still() || !all.is_still()) return false;
    Eigen::AlignedBox3d box = fixes_m;
    if (!block.fixes_m.front().empty()) box.extend(block.median_m());
    if (!box.isEmpty() && box.diagonal().norm() > rest_fixes_span_m) return false;
    readings = all;
    fixes_m = box;
    ++blocks;
    return true;
  }
};

}  // namespace

std::optional<rules::RestObservation> longest_rest(const Latest<ImuSample>& readings,
                                                   const Latest<UltrasonicFix>& fixes,
                                                   const calibration::Settings& calibration) {
  if (readings.entries().empty()) return std::nullopt;
  const std::vector<Block> blocks = blocks_of(readings, fixes);
  Rest longest;
  Rest current;
  for (const Block& block : blocks) {
    if (!current.extend(block)) {
      current = {};
      current.extend(block);
    }
    if (current.blocks > longest.blocks) longest = current;
  }
  if (longest.blocks < std::min(min_blocks, blocks.size())) return std::nullopt;
  const Readings mean = longest.readings.mean();
  ImuSample sample;
  sample.specific_force_body_mps2 = mean.head<3>();
  sample.angular_velocity_body_radps = mean.tail<3>();
  sample = calibration::Calibration(calibration).corrected(sample);
  return rules::RestObservation{.mean_force_body_mps2 = sample.specific_force_body_mps2,
                                .mean_rate_body_radps = sample.angular_velocity_body_radps,
                                .axes = calibration.axes};
}

}  // namespace sonopose::doctor::probe
