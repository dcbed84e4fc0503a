#pragma once
/// \file
/// Events and settings from random bytes, and the promises of an engine about its outputs.

#include "config/fusion_config.hpp"
#include "support.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <array>
#include <cmath>
#include <fuzzer/FuzzedDataProvider.h>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

namespace sonopose::fuzz {

/// The events of one beacon: runs of a plausible motion, and between them events with any values.
class EventStream {
public:
  EventStream(FuzzedDataProvider& data, TimeNs start_ns, BeaconAddress address)
      : data_(data), now_ns_(start_ns), address_(address) {}

  Event next() {
    if (plausible_left_ > 0) {
      --plausible_left_;
      return plausible();
    }
    const auto choice = data_.ConsumeIntegral<std::uint8_t>();
    constexpr std::uint8_t first_run = 192;
    if (choice >= first_run) {
      plausible_left_ = choice - first_run;
      return plausible();
    }
    return any(choice);
  }

  [[nodiscard]] bool has_more() const { return plausible_left_ > 0 || data_.remaining_bytes() > 0; }

private:
  static constexpr TimeNs period_ns = 40'000'000;

  /// Moves on a circle of 2 m in 6 s, with a fix every fifth sample, and a heading after it.
  Event plausible() {
    const int phase = phase_++ % 7;
    ++sequence_;
    constexpr double radius_m = 2;
    constexpr double rate_radps = std::numbers::pi / 3;
    const double angle = rate_radps * samples_ * static_cast<double>(period_ns) * 1e-9;
    if (phase == 5) {
      UltrasonicFix fix;
      stamp(fix, -70'000'000);
      fix.position_world_m = {radius_m * std::cos(angle), radius_m * std::sin(angle), 1};
      fix.quality_percent = 90;
      return fix;
    }
    if (phase == 6) {
      PairHeading heading;
      stamp(heading, -70'000'000);
      heading.heading_world_rad = angle + std::numbers::pi / 2;
      heading.valid = true;
      return heading;
    }
    now_ns_ = wrapping_sum(now_ns_, period_ns);
    ++samples_;
    ImuSample imu;
    imu.address = address_;
    imu.sequence = sequence_;
    imu.sensor_time_ns = now_ns_;
    imu.angular_velocity_body_radps = {0, 0, rate_radps};
    imu.specific_force_body_mps2 = {0, radius_m * rate_radps * rate_radps, standard_gravity_mps2};
    return imu;
  }

  Event any(std::uint8_t choice) {
    sequence_ += sequence_step(choice);
    now_ns_ =
        static_cast<TimeNs>(static_cast<std::uint64_t>(now_ns_) + static_cast<std::uint64_t>(time_step_ns()));
    switch (choice % 8) {
      case 0:
      case 4: {
        UltrasonicFix fix;
        stamp(fix, -time_step_ns());
        fix.position_world_m = vector();
        if (data_.ConsumeBool()) fix.quality_percent = number();
        if (data_.ConsumeBool()) fix.measured_delay_s = number();
        if (data_.ConsumeBool()) {
          fix.covariance_world_m2.emplace();
          for (int row = 0; row < 3; ++row) {
            for (int column = row; column < 3; ++column) fix.covariance_world_m2->set(row, column, number());
          }
        }
        return fix;
      }
      case 6: {
        TwistSample twist;
        stamp(twist, -time_step_ns());
        twist.velocity_body_mps = vector();
        twist.velocity_std_mps = vector();
        twist.axes = data_.ConsumeIntegral<std::uint8_t>();
        return twist;
      }
      case 1:
      case 5: {
        PairHeading heading;
        stamp(heading, -time_step_ns());
        heading.heading_world_rad = number();
        heading.valid = data_.ConsumeBool();
        return heading;
      }
      default: {
        ImuSample imu;
        imu.address = address_;
        imu.sequence = sequence_;
        imu.sensor_time_ns = now_ns_;
        imu.angular_velocity_body_radps = vector();
        imu.specific_force_body_mps2 = vector();
        if (data_.ConsumeBool()) imu.magnetic_field_body_t = vector();
        imu.meaning = static_cast<ImuMeaning>(data_.ConsumeIntegralInRange<std::uint32_t>(0, 2));
        return imu;
      }
    }
  }

  void stamp(auto& sample, TimeNs age_ns) const {
    sample.address = address_;
    sample.sequence = sequence_;
    sample.received_time_ns = now_ns_;
    sample.emission_time_ns = wrapping_sum(now_ns_, age_ns);
  }

  /// Adds with wraparound: any stamp may follow any other.
  static TimeNs wrapping_sum(TimeNs time_ns, TimeNs step_ns) {
    return static_cast<TimeNs>(static_cast<std::uint64_t>(time_ns) + static_cast<std::uint64_t>(step_ns));
  }

  std::uint64_t sequence_step(std::uint8_t choice) {
    if (choice < 160) return 1;
    constexpr std::uint64_t back = std::numeric_limits<std::uint64_t>::max();  // wraps around
    const std::array<std::uint64_t, 5> steps{0, 2, back, 100, data_.ConsumeIntegral<std::uint64_t>()};
    return data_.PickValueInArray(steps);
  }

  TimeNs time_step_ns() {
    const std::array<TimeNs, 8> steps{period_ns,
                                      period_ns,
                                      0,
                                      -50'000'000,
                                      300'000'000,
                                      5'000'000'000,
                                      -5'000'000'000,
                                      data_.ConsumeIntegral<std::uint8_t>() == 0xFF
                                          ? data_.ConsumeIntegralInRange<TimeNs>(-max_ns, max_ns)
                                          : 1'000'000};
    return data_.PickValueInArray(steps);
  }

  double number() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    const std::array numbers{0.0,
                             1.0,
                             -1.0,
                             9.8,
                             1e-3,
                             1e3,
                             1e9,
                             1e300,
                             -1e300,
                             1e-300,
                             inf,
                             -inf,
                             std::numeric_limits<double>::quiet_NaN()};
    const auto choice = data_.ConsumeIntegral<std::uint8_t>();
    if (choice < numbers.size()) return numbers.at(choice);
    return (choice - 128.0) / 8.0;
  }

  Vector3d vector() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }

  static constexpr TimeNs max_ns = std::numeric_limits<TimeNs>::max();

  FuzzedDataProvider& data_;
  TimeNs now_ns_;
  BeaconAddress address_;
  std::uint64_t sequence_ = 0;
  int phase_ = 0;
  int samples_ = 0;  ///< samples of the plausible motion
  int plausible_left_ = 0;
};

/// Returns a key of the table, or any text.
inline std::string setting_key(FuzzedDataProvider& data) {
  const auto& table = settings::setting_table();
  const auto row = data.ConsumeIntegralInRange<std::size_t>(0, table.size() + 3);
  return row < table.size() ? table[row].key : data.ConsumeRandomLengthString(80);
}

/// Returns a value that the key allows, or any text.
inline std::string setting_value(FuzzedDataProvider& data, const std::string& key) {
  const auto& table = settings::setting_table();
  const auto row =
      std::find_if(table.begin(), table.end(), [&key](const auto& one) { return one.key == key; });
  if (row == table.end() || data.ConsumeIntegral<std::uint8_t>() == 0) {
    return data.ConsumeRandomLengthString(150);
  }
  if (!row->choices.empty()) {
    return std::string(row->choices[data.ConsumeIntegralInRange<std::size_t>(0, row->choices.size() - 1)]);
  }
  if (std::holds_alternative<bool>(row->initial)) return data.ConsumeBool() ? "true" : "false";
  if (std::holds_alternative<int>(row->initial)) {
    return std::to_string(
        data.ConsumeIntegralInRange(std::get<int>(row->minimum), std::get<int>(row->maximum)));
  }
  if (!std::holds_alternative<double>(row->initial)) return data.ConsumeRandomLengthString(20);
  return settings::to_text(
      data.ConsumeFloatingPointInRange(std::get<double>(row->minimum), std::get<double>(row->maximum)));
}

template <int N>
bool is_finite(const Covariance<N>& covariance) {
  for (const double element : covariance.elements()) {
    if (!std::isfinite(element)) return false;
  }
  return true;
}

inline void check_pose(const FusedPose& pose) {
  promise(pose.position_world_m.allFinite() && pose.velocity_world_mps.allFinite(),
          "position and velocity of a pose are finite");
  constexpr double tolerance = 1e-6;
  promise(std::abs(pose.q_body_to_world.norm() - 1) < tolerance, "the attitude of a pose is a rotation");
  promise(pose.angular_velocity_body_radps.allFinite() && pose.acceleration_world_mps2.allFinite() &&
              pose.gyro_bias_body_radps.allFinite(),
          "rates, acceleration and bias of a pose are finite");
  promise(is_finite(pose.pose_covariance) && is_finite(pose.velocity_covariance),
          "the covariance of a pose is finite");
  promise(pose.trust >= 0 && pose.trust <= 1, "the trust of a pose is between 0 and 1");
  promise(pose.since_valid_fix_s >= 0, "a fix is not in the future");
}

inline void check_report(const FixReport& report) {
  promise(report.trust >= 0 && report.trust <= 1, "the trust of a report is between 0 and 1");
  if ((report.flags & fix_used) == 0) return;
  promise(report.position_world_m.allFinite() && report.shifted_position_world_m.allFinite() &&
              report.innovation_world_m.allFinite() && report.jump_world_m.allFinite() &&
              report.velocity_change_world_mps.allFinite() && std::isfinite(report.yaw_change_rad) &&
              std::isfinite(report.weight),
          "the report on a fix that was used is finite");
}

inline void check_result(const estimation::EventResult& result) {
  if (const auto* const pose = std::get_if<FusedPose>(&result)) check_pose(*pose);
  if (const auto* const report = std::get_if<FixReport>(&result)) check_report(*report);
}

}  // namespace sonopose::fuzz
