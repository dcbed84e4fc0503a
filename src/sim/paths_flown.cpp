/// The quadrotor's path: its attitude is the one that its acceleration needs.

#include "sim/paths.hpp"
#include "sim/taylor.hpp"
#include "marvelmind/conversions.hpp"

namespace sonopose::sim {

Path drone_path(double time_s) {
  const Taylor away = smoother_step(time_s, departure_s, 5.0);
  const double t = time_s - departure_s;
  const Taylor x = Taylor::constant(4.0) + away * (sine(2.0, 0.60, 0.0, t) + sine(0.25, 1.7, 1.0, t));
  const Taylor y = Taylor::constant(3.0) + away * (sine(1.3, 0.93, 0.5, t) + sine(0.15, 2.1, 0.0, t));
  const Taylor z = Taylor::constant(0.1) + away * (Taylor::constant(1.5) + sine(0.7, 0.45, -1.0, t));
  const Jet yaw = smooth_departure(time_s, departure_s, 4.0, 0.2);

  // The thrust per mass, turned into the frame that has the body's yaw: pitch and roll bring body Z onto it.
  const Jet thrust_x = x.second_derivative();
  const Jet thrust_y = y.second_derivative();
  const Jet thrust_z = marvelmind::standard_gravity_mps2 + z.second_derivative();
  const Jet forward = cos(yaw) * thrust_x + sin(yaw) * thrust_y;
  const Jet left = cos(yaw) * thrust_y - sin(yaw) * thrust_x;
  const Jet pitch = atan2(forward, thrust_z);
  const Jet in_plane = forward * sin(pitch) + thrust_z * cos(pitch);
  return {
      .x = x.jet(), .y = y.jet(), .z = z.jet(), .yaw = yaw, .pitch = pitch, .roll = atan2(-left, in_plane)};
}

}  // namespace sonopose::sim
