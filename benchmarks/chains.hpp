#pragma once
// The compared chains of three processes: source → relay → consumer. The consumer is this process.

#include "child.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::benchmarks {

/// The latency of one sample, s: from its publication to the relay, through it, and on to the consumer.
struct Latency {
  double to_relay_s = 0;
  double in_relay_s = 0;
  double to_consumer_s = 0;

  [[nodiscard]] double all_s() const { return to_relay_s + in_relay_s + to_consumer_s; }
};

struct Round {
  std::vector<Latency> latencies;
  double relay_cpu_s = 0;  ///< user and system time of the relay per sample
};

struct RoundOptions {
  std::uint32_t domain = 0;
  double rate_hz = 0;
  double length_s = 0;
};

struct Chain {
  std::string name;
  std::function<Round(const RoundOptions&)> run;  ///< throws std::runtime_error if no sample arrives
};

/// Variations of the real chain.
struct Tuning {
  std::string engine;     ///< fusion.engine; empty: the default
  std::string fusion{};   ///< path of the program; empty: that of this build
  bool realtime = false;  ///< --realtime for bridge and fusion, and real-time scheduling for the consumer
  bool awake = false;     ///< a process of the lowest priority keeps each core awake
  std::optional<unsigned> fusion_cpu{};  ///< core reserved for the fusion
  bool ros2 = false;  ///< sonopose-ros2 before the consumer; the CPU time is that of sonopose-ros2
};

/// Plain UDP sockets.
Chain plain_chain();
/// Cyclone DDS's C API alone.
Chain bare_chain(std::string name);
/// sonopose-bridge → sonopose-fusion → consumer.
Chain real_chain(std::string name, const Tuning& tuning = {});

}  // namespace sonopose::benchmarks
