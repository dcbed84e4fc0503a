#include "sim/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace sonopose::sim {

namespace {

/// Streams of random numbers, one per purpose, so that a change to one does not affect the others.
enum Stream : std::uint64_t {
  imu_stream = 1,
  ultrasonic_stream = 2,
  phase_stream = 3,
  start_yaw_stream = 4,
  imu_packet_stream = 5,
  position_packet_stream = 6,
  poor_fix_stream = 7,
  variation_stream = 8,
  imu_fault_stream = 9,
  wheel_stream = 10,
  fix_fault_stream = 11
};

Random stream_of(const Run& run, Stream stream) {
  return Random{run.seed, (std::uint64_t{run.address} << 8U) | stream};
}

const SensorSettings& checked(const SensorSettings& settings) {
  check(settings);
  return settings;
}

Scenario checked(Scenario scenario) {
  check(scenario.disturbances);
  return scenario;
}

/// Order of events that become available at the same time: IMU, fix, heading, velocity.
bool earlier(const Event& a, const Event& b) {
  return std::pair(available_at_ns(a), a.index()) < std::pair(available_at_ns(b), b.index());
}

}  // namespace

Scenario drawn(const Scenario& scenario, const Run& run) {
  Scenario result = scenario;
  if (result.vary != nullptr) {
    Random random = stream_of(run, variation_stream);
    result.vary(result, random);
    result.vary = nullptr;
  }
  return result;
}

Simulator::Simulator(const Scenario& scenario, const Run& run)
    : Simulator(scenario, drawn(scenario, run).sensors, run) {}

Simulator::Simulator(const Scenario& scenario, const SensorSettings& sensors, const Run& run)
    : scenario_{checked(drawn(scenario, run))},
      sensors_{checked(sensors)},
      run_{run},
      imu_{sensors, stream_of(run, imu_stream)},
      ultrasonic_{sensors, stream_of(run, ultrasonic_stream)},
      imu_packets_{scenario_.disturbances.imu_packets, stream_of(run, imu_packet_stream)},
      position_packets_{scenario_.disturbances.position_packets, stream_of(run, position_packet_stream)},
      wheels_{sensors, stream_of(run, wheel_stream)},
      poor_fixes_{stream_of(run, poor_fix_stream)},
      fix_faults_{stream_of(run, fix_fault_stream)},
      imu_faults_{stream_of(run, imu_fault_stream)},
      fix_phase_{stream_of(run, phase_stream).uniform()},
      start_yaw_rad_{scenario_.random_start_yaw
                         ? stream_of(run, start_yaw_stream).uniform_in({-std::numbers::pi, std::numbers::pi})
                         : 0.0} {
  if (std::isnan(run.duration_s)) throw std::invalid_argument("simulator: the duration is not a number");
}

std::optional<Step> Simulator::next() {
  while (true) {
    if (!arrived_imu_.empty()) {
      Step step = std::move(arrived_imu_.front());
      arrived_imu_.pop_front();
      return step;
    }
    const TimeNs imu_time_ns = time_of_sample(imu_count_, sensors_.imu_rate_hz, 0.0);
    emit_until(imu_time_ns);
    if (!under_way_.empty() && available_at_ns(under_way_.front()) < imu_time_ns) {
      Step step = arrived(std::move(under_way_.front()));
      under_way_.pop_front();
      return step;
    }
    if (since_start_s(imu_time_ns) >= run_.duration_s) return std::nullopt;
    take_imu_sample(imu_time_ns);
  }
}

Motion Simulator::motion_at(TimeNs time_ns) const {
  const double time_s = since_start_s(time_ns);
  Motion motion = scenario_.motion(time_s);
  if (scenario_.random_start_yaw) {
    motion = turned(motion, scenario_.motion(0.0).position_world_m, start_yaw_rad_);
  }
  return relocated(scenario_.disturbances, time_s, motion);
}

TimeNs Simulator::time_of_sample(std::uint64_t index, double rate_hz, double phase) const {
  return run_.start_time_ns + to_ns((static_cast<double>(index) + phase) / rate_hz);
}

double Simulator::since_start_s(TimeNs time_ns) const {
  return seconds_between(run_.start_time_ns, time_ns);
}

Step Simulator::arrived(Event event) {
  std::visit([this](auto& sample) { sample.sequence = ++sequence_; }, event);
  return {std::move(event), std::nullopt};
}

void Simulator::take_imu_sample(TimeNs time_ns) {
  ++imu_count_;
  const double time_s = since_start_s(time_ns);
  const Motion motion = motion_at(time_ns);
  ImuSample sample = imu_.measure(
      motion, gyro_drift_body_radps(scenario_.disturbances, time_s),
      [&](ImuSample& reading) { apply_imu_faults(scenario_.disturbances, time_s, imu_faults_, reading); });
  sample.address = run_.address;
  sample.sensor_time_ns = time_ns;
  const PacketFate fate = imu_packets_.next();
  if (fate.copies == 0 || is_outage(scenario_.disturbances.imu_outages, time_s)) return;
  if (fate.late_s > 0) {
    late_imu_.push_back({time_ns + to_ns(fate.late_s), sample});
    return;
  }
  deliver(sample, fate.copies);
  arrived_imu_.front().truth = {run_.address, time_ns, motion.position_world_m, motion.q_body_to_world,
                                motion.velocity_world_mps};
}

void Simulator::deliver(const ImuSample& sample, int copies) {
  for (int i = 0; i < copies; ++i) arrived_imu_.push_back(arrived(sample));
  std::erase_if(late_imu_, [this, &sample](const LateImu& late) {
    if (late.arrival_ns > sample.sensor_time_ns) return false;
    arrived_imu_.push_back(arrived(late.sample));
    return true;
  });
}

void Simulator::emit_until(TimeNs time_ns) {
  while (sensors_.wheel_rate_hz > 0 && time_of_sample(wheel_count_, sensors_.wheel_rate_hz, 0.5) <= time_ns) {
    measure_wheels();
  }
  const double rate_hz = ultrasonic_.fix_rate_hz();
  if (rate_hz <= 0) return;
  while (time_of_sample(emission_count_, rate_hz, fix_phase_) <= time_ns) emit_one();
}

void Simulator::emit_one() {
  const std::uint64_t number = emission_count_++;
  const TimeNs emission_ns = time_of_sample(number, ultrasonic_.fix_rate_hz(), fix_phase_);
  const double time_s = since_start_s(emission_ns);
  if (is_outage(scenario_.disturbances.outages, time_s)) return;
  if (is_left_out(scenario_.disturbances, time_s, number)) return;
  const TimeNs usually_received_ns = emission_ns + to_ns(ultrasonic_.next_delay_s());
  const Motion motion = motion_at(emission_ns);
  UltrasonicFix fix = measure_fix(motion, time_s);
  PairHeading heading =
      ultrasonic_.measure_heading(motion, heading_error_rad(scenario_.disturbances, time_s));
  fix.address = heading.address = run_.address;
  fix.emission_time_ns = heading.emission_time_ns = emission_ns - to_ns(sensors_.reported_delay_error_s);

  constexpr TimeNs copy_after_ns = 1'000'000;
  const PacketFate fate = position_packets_.next();
  for (int i = 0; i < fate.copies; ++i) {
    const TimeNs received_ns = usually_received_ns + to_ns(fate.late_s) + i * copy_after_ns;
    fix.received_time_ns = heading.received_time_ns = received_ns;
    fix.measured_delay_s = seconds_between(fix.emission_time_ns, received_ns);
    receive(fix);
    if (sensors_.pair_heading) receive(heading);
  }
}

void Simulator::measure_wheels() {
  const TimeNs time_ns = time_of_sample(wheel_count_++, sensors_.wheel_rate_hz, 0.5);
  TwistSample twist =
      wheels_.measure(motion_at(time_ns), wheel_slip(scenario_.disturbances, since_start_s(time_ns)));
  twist.address = run_.address;
  twist.emission_time_ns = time_ns;
  twist.received_time_ns = time_ns + to_ns(sensors_.wheel_delay_s);
  receive(twist);
}

UltrasonicFix Simulator::measure_fix(const Motion& motion, double time_s) {
  FixCondition condition;
  std::optional<Vector3d> default_world_m;
  Vector3d offset_world_m = track_offset_world_m(scenario_.disturbances, time_s, motion.position_world_m);
  if (const PoorFixes* kind = draw_poor_fix(scenario_.disturbances, poor_fixes_)) {
    condition = {kind->noise_factor, kind->quality_percent};
    offset_world_m += draw_offset_world_m(*kind, poor_fixes_);
    default_world_m = kind->default_world_m;
  }
  UltrasonicFix fix = ultrasonic_.measure_fix(motion, condition);
  offset_world_m += draw_fault_noise_world_m(scenario_.disturbances, time_s, fix_faults_);
  fix.position_world_m = default_world_m.value_or(fix.position_world_m + offset_world_m);
  if (repeats_position(scenario_.disturbances, time_s)) fix.position_world_m = last_position_world_m_;
  last_position_world_m_ = fix.position_world_m;
  return fix;
}

void Simulator::receive(const Event& event) {
  under_way_.insert(std::upper_bound(under_way_.begin(), under_way_.end(), event, earlier), event);
}

Recording record(const Scenario& scenario, const Run& run) {
  Run whole = run;
  if (std::isinf(whole.duration_s)) whole.duration_s = scenario.duration_s;
  Simulator simulator(scenario, whole);
  Recording recording;
  while (auto step = simulator.next()) {
    if (step->truth) recording.truth.push_back(*step->truth);
    recording.events.push_back(std::move(step->event));
  }
  return recording;
}

}  // namespace sonopose::sim
