#pragma once
/// \file
/// A secured bridge, a fusion, and a consumer of their poses.

#include "support/pose_tap.hpp"
#include "support/secured_bus.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>

namespace sonopose::test {

inline const Arguments rest{"--scenario", "rest", "--imu-rate", "200"};
inline const Environment unsecured{{"ROS_SECURITY_ENABLE", ""}};

struct SecuredChain {
  using Prepare = std::function<void(const KeyStoreOfRoles&)>;

  /// `prepare` is called before the processes start.
  explicit SecuredChain(const Prepare& prepare = [](const KeyStoreOfRoles&) {})
      : environment(prepared(keys, prepare)) {}

  static const security::KeyStore& prepared(const KeyStoreOfRoles& keys, const Prepare& prepare) {
    prepare(keys);
    return keys.store;
  }

  KeyStoreOfRoles keys;
  SecuredByEnvironment environment;
  Bus bus;
  PoseTap tap{bus};
  std::unique_ptr<Process> bridge = bus.bridge(rest);
  std::unique_ptr<Process> fusion = bus.fusion();
  std::set<std::uint64_t> owners = wait_for_owners();

  std::set<std::uint64_t> wait_for_owners() {
    REQUIRE(tap.wait_for_count(0, 100).size() >= 100);
    return tap.writers();
  }

  Arguments in_domain(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--domain", std::to_string(bus.domain_id())});
    return arguments;
  }

  /// Arguments of a fusion that would be the strongest of all.
  Arguments usurping(Arguments further) const {
    further.insert(further.end(), {"--standby-strength", "1000000", "--warm-up", "0"});
    return in_domain(further);
  }

  /// Checks that the poses go on and are all of the fusion.
  void check_undisturbed(std::size_t since) const {
    const std::size_t wanted = tap.count() - since + 400;
    const auto poses = tap.wait_for_count(since, wanted);
    REQUIRE(poses.size() >= wanted);
    for (const TappedPose& each : poses) REQUIRE(owners.contains(each.writer));
    CHECK(tap.writers() == owners);
  }
};

}  // namespace sonopose::test
