#include "support/beacon_feed.hpp"

#include "clocks/clocks.hpp"
#include "marvelmind/disassembler.hpp"
#include "marvelmind/encoder.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

namespace sonopose::test {
namespace {

constexpr TimeNs simulated_start_ns = sim::Run{}.start_time_ns;
constexpr TimeNs awake_before_ns = 1'000'000'000;  // avoids negative stamps

sim::Simulator simulator_of(BeaconAddress address, double imu_rate_hz) {
  const sim::Scenario& scenario = sim::find_scenario("walk");
  sim::SensorSettings sensors = scenario.sensors;
  sensors.imu_rate_hz = imu_rate_hz;
  return {scenario, sensors, sim::Run{.seed = address, .address = address}};
}

}  // namespace

struct BeaconFeed::Beacon {
  Beacon(BeaconAddress address, double imu_rate_hz)
      : woke_up(clocks::steady_now()),
        simulator(simulator_of(address, imu_rate_hz)),
        next(simulator.next()) {}

  [[nodiscard]] SteadyTime due() const {
    return next ? woke_up + (available_at_ns(next->event) - simulated_start_ns) : SteadyTime::max();
  }

  SteadyTime woke_up;
  sim::Simulator simulator;
  marvelmind::Disassembler disassembler{{.beacon_zero_ns = simulated_start_ns - awake_before_ns}};
  std::optional<sim::Step> next;
};

BeaconFeed::BeaconFeed(Format format, double imu_rate_hz, Send send)
    : format_(format),
      imu_rate_hz_(imu_rate_hz),
      send_(std::move(send)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

BeaconFeed::~BeaconFeed() = default;

void BeaconFeed::add(BeaconAddress address) {
  {
    const std::lock_guard lock(mutex_);
    beacons_[address] = std::make_unique<Beacon>(address, imu_rate_hz_);
  }
  wake_.notify_one();
}

void BeaconFeed::remove(BeaconAddress address) {
  const std::lock_guard lock(mutex_);
  beacons_.erase(address);
}

void BeaconFeed::delay(TimeNs delay_ns) {
  const std::lock_guard lock(mutex_);
  delay_ns_ = delay_ns;
}

void BeaconFeed::reorder(TimeNs max_ns) {
  const std::lock_guard lock(mutex_);
  reorder_ns_ = max_ns;
}

void BeaconFeed::send_garbage(std::uint32_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Bytes garbage(count);
  for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random());
  const std::lock_guard lock(mutex_);
  constexpr std::size_t piece = 40;
  const std::size_t size = format_ == Format::datagrams ? piece : garbage.size();
  for (std::size_t i = 0; i < garbage.size(); i += size) {
    send_(std::span(garbage).subspan(i, std::min(size, garbage.size() - i)));
  }
}

void BeaconFeed::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const SteadyTime now = clocks::steady_now();
    for (auto& entry : beacons_) {
      while (entry.second->due() <= now) measure(*entry.second);
    }
    while (!under_way_.empty() && under_way_.begin()->first <= now) {
      send_(under_way_.begin()->second);
      under_way_.erase(under_way_.begin());
    }
    const TimeNs longest_wait_ns = 1'000'000'000;
    const SteadyTime due = std::min(next_due(), now + longest_wait_ns);
    wake_.wait_until(lock, stop, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(due.ns)),
                     [&] { return next_due() < due; });
  }
}

void BeaconFeed::measure(Beacon& beacon) {
  const SteadyTime sent = beacon.due();
  beacon.disassembler.on(beacon.next->event, [&](const marvelmind::Packet& packet) {
    queue(format_ == Format::frames ? marvelmind::encode(packet).bytes()
                                    : marvelmind::encode_datagram(packet).bytes(),
          sent);
  });
  beacon.next = beacon.simulator.next();
}

void BeaconFeed::queue(std::span<const std::uint8_t> bytes, SteadyTime sent) {
  SteadyTime arrival = std::max(sent + delay_ns_, last_arrival_);
  if (reorder_ns_ != 0 && random_() % 3 == 0) {
    arrival += static_cast<TimeNs>(random_() % static_cast<std::uint64_t>(reorder_ns_));
  } else {
    last_arrival_ = arrival;
  }
  under_way_.emplace(arrival, Bytes(bytes.begin(), bytes.end()));
}

SteadyTime BeaconFeed::next_due() const {
  SteadyTime due = under_way_.empty() ? SteadyTime::max() : under_way_.begin()->first;
  for (const auto& entry : beacons_) due = std::min(due, entry.second->due());
  return due;
}

}  // namespace sonopose::test
