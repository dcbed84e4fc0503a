#include "bridge/simulator_source.hpp"

#include "bridge/capture.hpp"
#include "bridge/pacer.hpp"
#include "bridge/shifted.hpp"
#include "clocks/clocks.hpp"
#include "marvelmind/disassembler.hpp"
#include "marvelmind/encoder.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sonopose::bridge {
namespace {

/// Writes the bytes that a real beacon would have sent.
class BeaconCapture {
public:
  BeaconCapture(const std::filesystem::path& file, publication::FullQueuePolicy when_full, TimeNs wake_up_ns)
      : capture_(file, when_full), disassembler_({.beacon_zero_ns = wake_up_ns}) {}

  void on(const Event& event) {
    disassembler_.on(event, [this](const marvelmind::Packet& packet) {
      capture_.append(marvelmind::encode(packet).bytes());
    });
  }

  void obey(const process::StopSignal& stop) { capture_.obey(stop); }
  void finish() { capture_.finish(); }

private:
  Capture capture_;
  marvelmind::Disassembler disassembler_;
};

const SimulatorOptions& checked(const SimulatorOptions& options) {
  constexpr std::uint32_t highest = all_beacons - 1;
  if (options.beacons < 1 || options.beacons > max_simulated_beacons) {
    throw std::invalid_argument(
        fmt::format("beacons = {}: must be 1 to {}", options.beacons, max_simulated_beacons));
  }
  const std::uint32_t last = options.address + options.beacons - 1;
  if (last > highest) {
    throw std::invalid_argument(fmt::format(
        "--beacons: {} beacons from address {}: the last would have address {}, above the highest, {}",
        options.beacons, options.address, last, highest));
  }
  if (options.capture && options.beacons > 1) {
    throw std::invalid_argument(fmt::format(
        "--capture: a capture contains the bytes of one beacon: {} cannot contain those of {} beacons",
        options.capture->string(), options.beacons));
  }
  return options;
}

sim::SensorSettings sensors_of(const SimulatorOptions& options, const sim::Scenario& scenario) {
  sim::SensorSettings sensors = scenario.sensors;
  if (options.imu_rate_hz) sensors.imu_rate_hz = *options.imu_rate_hz;
  if (options.wheel_rate_hz) sensors.wheel_rate_hz = *options.wheel_rate_hz;
  return sensors;
}

/// Stationary beacons of the drawn map. Those of the scenario if it models any; otherwise one above each
/// corner of the area that the beacons visit in their first minute.
class SimulatedMap {
public:
  void add(const sim::Scenario& scenario, const sim::Simulator& simulator, const sim::Run& run) {
    if (const auto& misplaced = scenario.disturbances.misplaced_beacon) {
      positions_world_m_ = misplaced->beacons_world_m;
      positions_world_m_.at(misplaced->misplaced) += misplaced->map_error_m;
    }
    constexpr int seconds = 60;
    for (int s = 0; s <= seconds; ++s) {
      area_.extend(simulator.motion_at(run.start_time_ns + to_ns(s)).position_world_m);
    }
    last_address_ = std::max(last_address_, run.address);
  }

  /// The stationary beacons. Their addresses follow those of the mobile beacons.
  [[nodiscard]] std::vector<StationaryBeacon> beacons(TimeNs time_ns) const {
    std::vector<StationaryBeacon> beacons;
    for (const Vector3d& position_world_m : positions_world_m_.empty() ? corners() : positions_world_m_) {
      StationaryBeacon beacon;
      beacon.address = static_cast<BeaconAddress>(last_address_ + 1 + beacons.size());
      beacon.time_ns = time_ns;
      beacon.position_world_m = position_world_m;
      beacons.push_back(beacon);
    }
    return beacons;
  }

private:
  [[nodiscard]] std::vector<Vector3d> corners() const {
    constexpr double margin_m = 1.0;
    constexpr double above_m = 2.0;
    const Vector3d low = area_.min() - Vector3d::Constant(margin_m);
    const Vector3d high = area_.max() + Vector3d(margin_m, margin_m, above_m);
    return {{low.x(), low.y(), high.z()},
            {high.x(), low.y(), high.z()},
            {high.x(), high.y(), high.z()},
            {low.x(), high.y(), high.z()}};
  }

  std::vector<Vector3d> positions_world_m_;
  Eigen::AlignedBox3d area_;
  BeaconAddress last_address_ = 0;
};

/// One beacon and its next step.
struct SimulatedBeacon {
  SimulatedBeacon(const sim::Scenario& scenario, const sim::SensorSettings& sensors, const sim::Run& run)
      : simulator(scenario, sensors, run), next(simulator.next()) {}

  sim::Simulator simulator;
  std::optional<sim::Step> next;
};

/// Several beacons as one stream of steps, ordered by availability.
class MergedBeacons {
public:
  MergedBeacons(const SimulatorOptions& options, TimeNs start_ns) {
    const sim::Scenario& scenario = sim::find_scenario(options.scenario);
    const double imu_rate_hz = sensors_of(options, scenario).imu_rate_hz;
    const double endless_s = std::numeric_limits<double>::infinity();
    beacons_.reserve(options.beacons);
    for (std::uint32_t i = 0; i < options.beacons; ++i) {
      // Spread over one period to avoid bursts.
      const double phase_s = i / (options.beacons * imu_rate_hz);
      const sim::Run run{.seed = options.seed + i,
                         .start_time_ns = start_ns + to_ns(phase_s),
                         .address = static_cast<BeaconAddress>(options.address + i),
                         .duration_s = options.duration_s > 0 ? options.duration_s : endless_s};
      const sim::Scenario drawn = sim::drawn(scenario, run);
      beacons_.emplace_back(drawn, sensors_of(options, drawn), run);
      map_.add(drawn, beacons_.back().simulator, run);
      push(i);
    }
  }

  /// The next step; null at the end. Valid until `pop`.
  [[nodiscard]] const sim::Step* front() const {
    return waiting_.empty() ? nullptr : &*beacons_[waiting_.front().beacon].next;
  }

  /// Removes and returns the next step, which must exist.
  sim::Step pop() {
    std::pop_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    const std::size_t index = waiting_.back().beacon;
    waiting_.pop_back();
    SimulatedBeacon& beacon = beacons_[index];
    sim::Step step = *std::exchange(beacon.next, beacon.simulator.next());
    push(index);
    return step;
  }

  [[nodiscard]] const SimulatedMap& map() const { return map_; }

private:
  struct Waiting {
    TimeNs available_ns;
    std::size_t beacon;
    auto operator<=>(const Waiting&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
  };

  void push(std::size_t index) {
    if (!beacons_[index].next) return;
    waiting_.push_back({available_at_ns(beacons_[index].next->event), index});
    std::push_heap(waiting_.begin(), waiting_.end(), std::greater<>());
  }

  std::vector<SimulatedBeacon> beacons_;
  SimulatedMap map_;
  std::vector<Waiting> waiting_;  ///< heap, earliest first; without ended beacons
};

class SimulatorSource final : public publication::Source {
public:
  explicit SimulatorSource(const SimulatorOptions& options)
      : pacer_(options.rate), beacons_(options, simulated_start_ns) {
    // A beacon wakes up before it measures, so its first stamp is not negative.
    constexpr TimeNs awake_before_ns = 1'000'000'000;
    const publication::FullQueuePolicy when_full =
        options.rate == 0.0 ? publication::FullQueuePolicy::wait : publication::FullQueuePolicy::lose;
    if (options.capture) capture_.emplace(*options.capture, when_full, simulated_start_ns - awake_before_ns);
  }

  void run(publication::SampleSink& sink, const process::StopSignal& stop) override {
    if (capture_) capture_->obey(stop);
    // Shift the run to start now, after the set-up. At rate 1 each sample then appears at its own stamp.
    const TimeNs shift_ns = clocks::host_now() - simulated_start_ns;
    for (const StationaryBeacon& beacon : beacons_.map().beacons(clocks::host_now()))
      sink.on_stationary(beacon);
    for (const sim::Step* step = beacons_.front(); step != nullptr; step = beacons_.front()) {
      if (!pacer_.wait_for(available_at_ns(step->event), sink, stop)) return;
      // Simulate the next step before publishing this one: the readers may need the core afterwards.
      const sim::Step due = beacons_.pop();
      if (due.truth) sink.on(shifted(*due.truth, shift_ns));
      sink.on(shifted(due.event, shift_ns));
      if (capture_) capture_->on(due.event);
    }
  }

  void finish() override {
    if (capture_) capture_->finish();
  }

private:
  static constexpr TimeNs simulated_start_ns = sim::Run{}.start_time_ns;

  Pacer pacer_;
  MergedBeacons beacons_;
  std::optional<BeaconCapture> capture_;
};

}  // namespace

std::unique_ptr<publication::Source> make_simulator_source(const SimulatorOptions& options) {
  return std::make_unique<SimulatorSource>(checked(options));
}

}  // namespace sonopose::bridge
