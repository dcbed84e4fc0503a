#include <sonopose/sim/simulator.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace sonopose::sim {

namespace {

/// One stream of random numbers for each sensor, so that a change to one does not disturb the others.
enum Stream : std::uint64_t { imu_stream = 1, ultrasonic_stream = 2, phase_stream = 3 };

Random stream_of(const Run& run, Stream stream) {
  return Random{run.seed, (std::uint64_t{run.address} << 8U) | stream};
}

const SensorSettings& checked(const SensorSettings& settings) {
  check(settings);
  return settings;
}

}  // namespace

Simulator::Simulator(const Scenario& scenario, const SensorSettings& settings, const Run& run)
    : scenario_{scenario},
      settings_{checked(settings)},
      run_{run},
      imu_{settings, stream_of(run, imu_stream)},
      ultrasonic_{settings, stream_of(run, ultrasonic_stream)},
      fix_phase_{stream_of(run, phase_stream).uniform()} {
  if (std::isnan(run.duration_s)) throw std::invalid_argument("simulator: the duration is not a number");
}

std::optional<Step> Simulator::next() {
  const TimeNs imu_time_ns = time_of_sample(imu_count_, settings_.imu_rate_hz, 0.0);
  emit_until(imu_time_ns);
  const bool over = seconds_between(run_.start_time_ns, imu_time_ns) >= run_.duration_s;
  if (!under_way_.empty() && available_at_ns(under_way_.front()) < imu_time_ns) {
    Step step{std::move(under_way_.front()), std::nullopt};
    under_way_.pop_front();
    std::visit([this](auto& sample) { sample.sequence = ++sequence_; }, step.event);
    return step;
  }
  if (over) return std::nullopt;
  return take_imu_sample(imu_time_ns);
}

TimeNs Simulator::time_of_sample(std::uint64_t index, double rate_hz, double phase) const {
  return run_.start_time_ns + to_ns((static_cast<double>(index) + phase) / rate_hz);
}

Motion Simulator::motion_at(TimeNs time_ns) const {
  return scenario_.motion(seconds_between(run_.start_time_ns, time_ns));
}

Step Simulator::take_imu_sample(TimeNs time_ns) {
  ++imu_count_;
  const Motion motion = motion_at(time_ns);
  ImuSample sample = imu_.measure(motion);
  sample.address = run_.address;
  sample.sequence = ++sequence_;
  sample.sensor_time_ns = time_ns;
  const TruthSample truth{run_.address, time_ns, motion.position_world_m, motion.q_body_to_world,
                          motion.velocity_world_mps};
  return {sample, truth};
}

void Simulator::emit_until(TimeNs time_ns) {
  if (settings_.fix_rate_hz <= 0) return;
  while (time_of_sample(emission_count_, settings_.fix_rate_hz, fix_phase_) <= time_ns) emit_one();
}

void Simulator::emit_one() {
  const TimeNs emission_ns = time_of_sample(emission_count_++, settings_.fix_rate_hz, fix_phase_);
  const TimeNs received_ns = emission_ns + to_ns(ultrasonic_.next_delay_s());
  const Motion motion = motion_at(emission_ns);
  const auto receive = [&](auto sample) {
    sample.address = run_.address;
    sample.emission_time_ns = emission_ns;
    sample.received_time_ns = received_ns;
    const auto later = [](TimeNs time_ns, const Event& event) { return time_ns < available_at_ns(event); };
    under_way_.insert(std::upper_bound(under_way_.begin(), under_way_.end(), received_ns, later), sample);
  };
  UltrasonicFix fix = ultrasonic_.measure_fix(motion);
  fix.measured_delay_s = seconds_between(emission_ns, received_ns);
  receive(fix);
  if (settings_.pair_heading) receive(ultrasonic_.measure_heading(motion));
}

}  // namespace sonopose::sim
