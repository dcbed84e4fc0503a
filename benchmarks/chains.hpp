#pragma once
// The chains whose latency is compared, each of three processes: source → relay → consumer, the last of which
// is this one.

#include "child.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::benchmarks {

/// The way of one sample, s: from its publication to the relay, through it, and on to the consumer.
struct Way {
  double to_relay_s = 0;
  double in_relay_s = 0;
  double to_consumer_s = 0;

  [[nodiscard]] double all_s() const { return to_relay_s + in_relay_s + to_consumer_s; }
};

/// What one round of a chain gave.
struct Round {
  std::vector<Way> ways;
  double relay_cpu_s = 0;  ///< user and system time of the relay per sample
};

/// How long a round is, and where.
struct RoundOptions {
  std::uint32_t domain = 0;
  double rate_hz = 0;
  double length_s = 0;
};

struct Chain {
  std::string name;
  std::function<Round(const RoundOptions&)> run;  ///< throws std::runtime_error where nothing comes through
};

/// What changes in the real chain.
struct Tuning {
  bool realtime = false;  ///< --realtime for bridge and fusion, the same for the consumer
  bool awake = false;     ///< a process of the lowest priority keeps each core from falling asleep
  std::optional<unsigned> fusion_cpu;  ///< the core for the fusion alone
  bool ros2 = false;                   ///< sonopose-ros2 stands before the consumer; the CPU time is its own
};

/// Plain UDP sockets.
Chain plain_chain();
/// Cyclone DDS's C API alone.
Chain bare_chain();
/// sonopose-bridge → sonopose-fusion → consumer.
Chain real_chain(std::string name, const Tuning& tuning = {});

}  // namespace sonopose::benchmarks
