#pragma once
/// \file
/// Two fusions with the same inputs, and a consumer of their poses.

#include "support/pose_tap.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <memory>
#include <set>
#include <string>

namespace sonopose::test {

inline constexpr TimeNs lease_ns = 100'000'000;
inline constexpr TimeNs imu_period_ns = 5'000'000;
inline constexpr BeaconAddress contested = 7;   ///< both fusions have this beacon
inline constexpr BeaconAddress undisputed = 8;  ///< only the weak fusion has this beacon

using Writers = std::set<std::uint64_t>;

/// A fusion of the pair, with its writers as matched by the tap.
struct Fusion {
  std::unique_ptr<Process> process;
  Writers writers;
  std::uint64_t claim = 0;  ///< the writer with the ownership strength

  [[nodiscard]] bool wrote(const TappedPose& tapped) const { return writers.contains(tapped.writer); }
};

/// A bus with a bridge, a tap, and fusions on request.
class Pair {
public:
  explicit Pair(const Arguments& source = {"--scenario", "rest", "--imu-rate", "200"})
      : tap(bus), bridge(bus.bridge(source)) {}

  Fusion start(const std::string& strength, const Arguments& further = {"--warm-up", "0.2"}) {
    const Writers before = tap.writers();
    Fusion fusion;
    Arguments arguments{"--standby-strength", strength};
    arguments.insert(arguments.end(), further.begin(), further.end());
    fusion.process = bus.fusion(arguments);
    wait_until([&] {
      fusion.writers = tap.writers();
      for (const auto handle : before) fusion.writers.erase(handle);
      return fusion.writers.size() >= 2;
    });
    REQUIRE(fusion.writers.size() == 2);
    for (const auto writer : fusion.writers) {
      if (tap.strength_of(writer) > 0) fusion.claim = writer;
    }
    return fusion;
  }

  /// Waits until the consumer receives a new pose of this fusion.
  void wait_until_served_by(const Fusion& fusion) {
    REQUIRE(tap.wait_for_writer({fusion.claim}, tap.count()));
  }

  Bus bus;
  PoseTap tap;
  std::unique_ptr<Process> bridge;
};

/// A pair whose stronger fusion has only one of two beacons.
struct UnequalPair : Pair {
  explicit UnequalPair(const std::string& scenario = "rest", const std::string& engine = "kalman")
      : Pair({"--scenario", scenario, "--imu-rate", "200", "--beacons", "2"}),
        quick{"--warm-up", "0.2", "--set", "fusion.engine=" + engine},
        weak(start("100", quick)) {
    start_strong();
  }

  void start_strong() {
    Arguments arguments = quick;
    arguments.insert(arguments.end(), {"--addresses", std::to_string(contested)});
    strong = start("200", arguments);
    wait_until_served_by(strong);
  }

  Arguments quick;
  Fusion weak;
  Fusion strong;
};

}  // namespace sonopose::test
