#pragma once
/// \file
/// Simulated beacons that send in real time, over a line that can delay, reorder and damage.

#include <sonopose/samples/samples.hpp>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <span>
#include <thread>
#include <vector>

namespace sonopose::test {

class BeaconFeed {
public:
  enum class Format : std::uint8_t { frames, datagrams };
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  /// Starts a thread that calls `send`.
  BeaconFeed(Format format, double imu_rate_hz, Send send);
  BeaconFeed(const BeaconFeed&) = delete;
  BeaconFeed& operator=(const BeaconFeed&) = delete;
  ~BeaconFeed();

  /// Adds a beacon that wakes up now and walks.
  void add(BeaconAddress address);
  void remove(BeaconAddress address);

  /// Delays all further frames by this time, in order.
  void delay(TimeNs delay_ns);
  /// Delays a third of the further frames by up to this time, out of order.
  void reorder(TimeNs max_ns);
  /// Sends random bytes now; split into datagrams if the format has them.
  void send_garbage(std::uint32_t count, std::uint64_t seed);

private:
  struct Beacon;
  using Bytes = std::vector<std::uint8_t>;

  void run(const std::stop_token& stop);
  void measure(Beacon& beacon);
  void queue(std::span<const std::uint8_t> bytes, SteadyTime sent);
  [[nodiscard]] SteadyTime next_due() const;

  Format format_;
  double imu_rate_hz_;
  Send send_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::map<BeaconAddress, std::unique_ptr<Beacon>> beacons_;
  std::multimap<SteadyTime, Bytes> under_way_;  ///< by arrival time
  TimeNs delay_ns_ = 0;
  TimeNs reorder_ns_ = 0;
  SteadyTime last_arrival_;
  std::mt19937_64 random_;
  std::jthread thread_;
};

}  // namespace sonopose::test
