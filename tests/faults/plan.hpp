#pragma once
/// \file
/// What happens to the processes and the line of one run: drawn from a seed, so that a run can be repeated.

#include <sonopose/samples/time.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::faults {

/// The processes under test. The fusions stand by for each other, the strongest first.
enum class Role : std::uint8_t { bridge, first_fusion, second_fusion, third_fusion };

inline constexpr std::array all_roles{Role::bridge, Role::first_fusion, Role::second_fusion,
                                      Role::third_fusion};

/// Ownership strength of a fusion; 0 for the bridge.
std::int32_t strength_of(Role role);

/// The role of the fusion with this strength.
std::optional<Role> role_of(std::int32_t strength);

enum class Fault : std::uint8_t {
  kill,             ///< SIGKILL, and a restart after `for_ns`
  terminate,        ///< SIGTERM, and a restart after `for_ns`
  stop,             ///< SIGSTOP, and SIGCONT after `for_ns`
  clock_step,       ///< the host's clock of one process is set by `amount_ns` and stays so
  few_descriptors,  ///< one more fusion starts that may open `count` files
  delay,            ///< what beacons send arrives `amount_ns` later, in order
  reorder,          ///< datagrams arrive up to `amount_ns` later, out of order
  garbage,          ///< `count` random bytes between good frames, at the start and at the end
  unplug            ///< the serial line is absent
};

struct Step {
  TimeNs at_ns = 0;  ///< after the start of the faults
  Fault fault = Fault::kill;
  Role target = Role::bridge;
  TimeNs for_ns = 0;
  TimeNs amount_ns = 0;
  std::uint32_t count = 0;

  bool operator==(const Step&) const = default;
};

enum class Line : std::uint8_t { serial, udp };

/// Where the bridge writes to, besides the bus.
enum class Disk : std::uint8_t { none, full, slow };

/// A process that loses this share of the packets that it sends.
struct Loss {
  Role role = Role::bridge;
  std::uint32_t permille = 0;

  bool operator==(const Loss&) const = default;
};

struct Plan {
  std::uint64_t seed = 0;
  Line line = Line::serial;
  int fusions = 2;
  Disk disk = Disk::none;
  std::optional<Loss> loss;
  std::vector<Step> steps;  ///< by time; no two on the same target at once

  bool operator==(const Plan&) const = default;
};

/// The plan of this seed, always the same. Without `clock_steps` it has none of them.
Plan draw_plan(std::uint64_t seed, bool clock_steps = true);

/// Seeds whose plans together have every fault of a bridge and of a fusion, except an unplugged line and a
/// step of the bridge's clock, on both lines and both disks.
inline constexpr std::array<std::uint64_t, 3> short_seeds{901, 1018, 1089};

/// The process whose clock the plan steps.
std::optional<Role> stepped_clock(const Plan& plan);

/// One line, such as "serial, 2 fusions: 0.31 s kill fusion-300 for 0.42 s".
std::string text_of(const Plan& plan);
std::string text_of(const Step& step);
std::string text_of(Role role);

}  // namespace sonopose::faults
