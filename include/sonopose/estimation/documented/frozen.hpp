#pragma once
/// \file
/// The frozen track: fixes that repeat the same coordinates while the IMU says that the body moves. (At rest
/// real beacons repeat coordinates too.)

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>

namespace sonopose::estimation::documented {

struct FrozenSettings {
  double moved_m{};
  double window_s{};
  int repeats{};

  static constexpr std::string_view group = "frozen";
  static constexpr auto declarations() {
    using G = FrozenSettings;
    using settings::own_setting;
    return settings::rows(
        settings::real(own_setting, "moved_m", &G::moved_m, 0.3, {0.01, 10.0}, "m",
                      "The track is frozen when the IMU has moved this far while the coordinates repeated."),
        settings::real(
            own_setting, "window_s", &G::window_s, 1.0, {0.1, 10.0}, "s",
            "Time within which it must have moved that far; longer, and the IMU's drift would count."),
        settings::count(own_setting, "repeats", &G::repeats, 3, {1, 1000}, "fixes",
                       "Least number of repetitions before a track can be called frozen."));
  }
  constexpr FrozenSettings() { settings::set_defaults(*this); }
};

struct FrozenState {
  bool has_fix = false;
  bool frozen = false;
  int repeats = 0;
  Vector3d coordinates_world_m = Vector3d::Zero();
  // Where the window began: the IMU's path since then, with the velocity as it was then, because fixes of a
  // frozen track pull the velocity to zero.
  TimeNs window_began_ns = 0;
  Vector3d window_displacement_world_m = Vector3d::Zero();
  Vector3d window_corrections_world_mps = Vector3d::Zero();

  bool operator==(const FrozenState&) const = default;
};

namespace frozen {

/// Takes note of an admitted fix; true while the track counts as frozen. Ends with the first new coordinate.
bool watch(const FrozenSettings& settings, FrozenState& state, const Kinematics& body,
           const UltrasonicFix& fix);

/// The IMU's path has a hole here: what it draws from now on is measured from here.
void begin_window(FrozenState& state, const Kinematics& body);

}  // namespace frozen
}  // namespace sonopose::estimation::documented
