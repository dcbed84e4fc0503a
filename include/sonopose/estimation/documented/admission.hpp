#pragma once
/// \file
/// What may enter the engine: finite, possible, in order, and (item 12) of sufficient quality.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>

#include <cstdint>

namespace sonopose::estimation::documented {

struct AdmissionSettings {
  double min_quality_percent{};
  double max_position_m{};
  double max_specific_force_mps2{};
  double max_angular_rate_radps{};
  double max_fix_age_s{};

  static constexpr std::string_view group = "admission";
  static constexpr auto declarations() {
    using G = AdmissionSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(12, "min_quality_percent", &G::min_quality_percent, 50.0, {0.0, 100.0}, "%",
             "Fixes of a lower reported quality are not used; fixes without a quality are."),
        real(own_setting, "max_position_m", &G::max_position_m, 1e4, {1.0, 1e6}, "m",
             "A fix with a coordinate beyond this is no measurement."),
        real(own_setting, "max_specific_force_mps2", &G::max_specific_force_mps2, 400.0, {20.0, 1e4}, "m/s^2",
             "An IMU sample with a specific force beyond this is no measurement."),
        real(own_setting, "max_angular_rate_radps", &G::max_angular_rate_radps, 80.0, {5.0, 1e3}, "rad/s",
             "An IMU sample with an angular rate beyond this is no measurement."),
        real(own_setting, "max_fix_age_s", &G::max_fix_age_s, 0.9, {0.1, 1.0}, "s",
             "A fix or heading measured longer ago than this, longer under way, or in the future, is not "
             "used."));
  }
  constexpr AdmissionSettings() { settings::set_defaults(*this); }
};

struct AdmissionState {
  int backward_in_row = 0;          ///< IMU samples from before the state's time, one after the other
  TimeNs last_fix_measured_ns = 0;  ///< of the latest admitted fix; 0 before the first
  TimeNs announced_ns = 0;          ///< stamp of a sample that was too far ahead to be believed alone; or 0

  bool operator==(const AdmissionState&) const = default;
};

namespace admission {

/// Whether a stamp can be a time at all: differences of such stamps do not overflow.
[[nodiscard]] bool is_time(TimeNs stamp_ns);

/// Whether an IMU sample can be a measurement that follows the state at `now_ns` (0: none yet). Equal stamps
/// may: a clock of whole milliseconds gives them to samples that were measured apart.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const ImuSample& imu);

/// Whether an admissible sample lies so far ahead of the state's time that it is not believed before the next
/// one confirms it: one broken stamp must not cost all that follows.
[[nodiscard]] bool is_sudden(AdmissionState& state, TimeNs now_ns, const ImuSample& imu);

/// Takes note of a sample that was not admitted. True when so many in a row came from before the state's time
/// that it is the time that was wrong: the host's clock has been set back, or one stamp lay far in the
/// future.
[[nodiscard]] bool time_was_wrong(AdmissionState& state, TimeNs now_ns, const ImuSample& imu);

/// Whether a heading that was measured at `measured_ns` can be a measurement of this time.
[[nodiscard]] bool admits(const AdmissionSettings& settings, TimeNs now_ns, const PairHeading& heading,
                          TimeNs measured_ns);

/// The bits of FixFlag that keep a fix out that was measured at `measured_ns` (0: it is admitted, and
/// remembered).
[[nodiscard]] std::uint32_t reasons_against(const AdmissionSettings& settings, AdmissionState& state,
                                            TimeNs now_ns, const UltrasonicFix& fix, TimeNs measured_ns);

}  // namespace admission
}  // namespace sonopose::estimation::documented
