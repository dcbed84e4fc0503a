#pragma once
/// \file
/// Items 10 and 11: behaviour while no valid fix or no IMU sample arrives.

#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::estimation::documented {

using settings::OutageSettings;

/// State that the next valid fix sets outright, until the engine tracks the ultrasound.
enum class InitPhase : std::uint8_t {
  no_position,  ///< no fix yet, or stale: the next valid fix sets the position
  no_velocity,  ///< the next valid fix sets the velocity
  tracking      ///< fixes correct position, velocity and yaw
};
constexpr std::array<std::string_view, 3> choices_of(InitPhase /*phase*/) {
  return {"no_position", "no_velocity", "tracking"};
}

struct OutageState {
  TimeNs last_valid_fix_ns = 0;  ///< receipt time of the last valid fix; 0 before the first
  InitPhase init_phase = InitPhase::no_position;
  bool stale = false;

  bool operator==(const OutageState&) const = default;
};

namespace outage {

/// True if the time between two IMU samples is too long to integrate over.
[[nodiscard]] bool is_imu_gap(const OutageSettings& settings, double dt_s);

/// True if an event at `then_ns` is not yet stale.
[[nodiscard]] bool is_recent(const OutageSettings& settings, TimeNs then_ns, TimeNs now_ns);

/// True if acceleration must be ignored at `now_ns`. When stale mode begins, the next fix sets the position.
bool update(const OutageSettings& settings, OutageState& state, TimeNs now_ns);

/// Performs one step of stale mode: the speed falls as exp(−rate·t).
void decay(const OutageSettings& settings, Kinematics& body, double dt_s);

}  // namespace outage
}  // namespace sonopose::estimation::documented
