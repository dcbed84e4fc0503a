// A driver of its own: publishes a beacon that moves on a circle, its IMU at 100 Hz and its fixes at 8 Hz.
// Ends after as many seconds as its argument says, or by Ctrl-C.

#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <thread>

namespace {

using namespace sonopose;

constexpr BeaconAddress address = 42;
constexpr double radius_m = 2.0;
constexpr double turn_rate_radps = 0.5;  // counter-clockwise, at 1 m/s
constexpr double fix_delay_s = 0.07;     // from the emission of a fix to its receipt

volatile std::sig_atomic_t stopped = 0;

TimeNs host_now() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

int main(int argc, char** argv) {
  const double max_duration_s = argc > 1 ? std::strtod(argv[1], nullptr) : 1e9;
  std::signal(SIGINT, [](int) { stopped = 1; });

  namespace dds = sonopose::dds;
  const auto participant = dds::ext::participant();
  const dds::qos::Provider qos;
  auto imu_writer = dds::topics::make_writer(participant, qos, dds::topics::imu);
  auto fix_writer = dds::topics::make_writer(participant, qos, dds::topics::fix);

  ImuSample imu;  // body X points ahead: the acceleration is along Y
  imu.address = address;
  imu.angular_velocity_body_radps = {0.0, 0.0, turn_rate_radps};
  imu.specific_force_body_mps2 = {0.0, radius_m * turn_rate_radps * turn_rate_radps, standard_gravity_mps2};
  imu.meaning = ImuMeaning::instant;
  UltrasonicFix fix;
  fix.address = address;
  fix.measured_delay_s = fix_delay_s;

  std::uint64_t sequence = 0;  // one numbering over all streams of the beacon, without gaps
  const TimeNs start_ns = host_now();
  const auto start = std::chrono::steady_clock::now();
  for (long i = 1; stopped == 0 && 0.01 * static_cast<double>(i) <= max_duration_s; ++i) {
    std::this_thread::sleep_until(start + std::chrono::milliseconds(10 * i));
    imu.sequence = ++sequence;
    imu.sensor_time_ns = start_ns + 10'000'000 * i;
    imu.bridge_time_ns = host_now();
    // Does not throw: a slow reader must not end the driver.
    dds::ext::try_write(imu_writer, dds::topics::to_idl(imu));
    if (i % 25 != 0 && i % 25 != 12) continue;  // eight of a hundred
    fix.sequence = ++sequence;
    fix.received_time_ns = imu.sensor_time_ns;
    fix.emission_time_ns = fix.received_time_ns - to_ns(fix_delay_s);
    const double angle_rad = turn_rate_radps * seconds_between(start_ns, fix.emission_time_ns);
    fix.position_world_m = {radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), 0.5};
    dds::ext::try_write(fix_writer, dds::topics::to_idl(fix));
  }
}
