#pragma once
/// \file
/// Detects that all fixes of a beacon are refused, and the reason.

#include <sonopose/estimation/aiding/reading_limits.hpp>
#include <sonopose/samples/fix_refusal.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace sonopose::estimation::aiding {

/// Refused fixes by cause. A fix is refused if it is too old, from the future, out of order, out of range or
/// of low quality. Outliers are judged, not refused.
class RefusedFixes {
public:
  /// Takes a report of the engine; returns false if its fix was not refused. Does not allocate.
  bool on(const FixReport& report) noexcept;

  /// Takes an IMU sample, which may exceed a limit of the settings.
  void on(const ImuSample& imu, const settings::AdmissionSettings& settings) noexcept {
    imu_.count(exceeded_limit(settings, imu));
  }
  /// Takes a fix before its report, likewise.
  void on(const UltrasonicFix& fix, const settings::AdmissionSettings& settings) noexcept {
    positions_.count(exceeded_limit(settings, fix));
  }

  [[nodiscard]] std::uint64_t count() const;

  /// The IMU samples without the fixes.
  [[nodiscard]] RefusedFixes imu_alone() const {
    RefusedFixes alone;
    alone.imu_ = imu_;
    return alone;
  }

  /// The most frequent cause; empty without a refused fix.
  [[nodiscard]] std::string reason() const;

  /// True if most were refused for times that do not fit those of the IMU samples.
  [[nodiscard]] bool are_of_another_clock() const;

private:
  struct Refused {
    std::uint64_t fixes = 0;
    double age_s = 0;  ///< age of the latest one
  };
  [[nodiscard]] FixRefusal most_frequent() const;

  struct Excess {
    std::uint64_t samples = 0;
    ExceededLimit limit;  ///< that of the latest one

    void count(const std::optional<ExceededLimit>& exceeded) noexcept {
      if (!exceeded) return;
      ++samples;
      limit = *exceeded;
    }
  };

  std::array<Refused, fix_refusal_count> refused_;
  Excess imu_;
  Excess positions_;
};

/// Refusals of one beacon since the last accepted fix. Call `update` about once a second.
class FixRefusals {
public:
  static constexpr TimeNs timeout_ns = 1'000'000'000;

  /// Takes a report of the engine. Does not allocate.
  void on(const FixReport& report) noexcept;

  /// Takes a sample before it is processed (RefusedFixes).
  void on(const Event& event, const settings::AdmissionSettings& settings) noexcept;

  /// A message for the user: once when all fixes have been refused for `timeout_ns`, with the most frequent
  /// cause, and once when one is accepted again; for each refused pose that the user has set.
  std::optional<std::string> update(SteadyTime now);

private:
  RefusedFixes refused_;
  RefusedFixes set_pose_;     ///< the latest pose that the user has set
  bool is_set_pose_ = false;  ///< the latest fix is one
  std::optional<SteadyTime> since_;
  bool reported_ = false;
};

}  // namespace sonopose::estimation::aiding
