#pragma once
/// \file
/// Faults of the processes and the line in one run, drawn from a seed so that a run can be repeated.

#include <sonopose/samples/time.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::faults {

/// Processes under test. The fusions stand by for each other, strongest first.
enum class Role : std::uint8_t { bridge, first_fusion, second_fusion, third_fusion };

inline constexpr std::array all_roles{Role::bridge, Role::first_fusion, Role::second_fusion,
                                      Role::third_fusion};

/// Ownership strength of a fusion; 0 for the bridge.
std::int32_t strength_of(Role role);

/// Role of the fusion with this strength.
std::optional<Role> role_of(std::int32_t strength);

enum class Fault : std::uint8_t {
  kill,             ///< SIGKILL, restart after `for_ns`
  terminate,        ///< SIGTERM, restart after `for_ns`
  stop,             ///< SIGSTOP, SIGCONT after `for_ns`
  clock_step,       ///< permanent step of one process's host clock by `amount_ns`
  few_descriptors,  ///< one more fusion, which may open `count` files, starts
  delay,            ///< data of the beacons arrives `amount_ns` later, in order
  reorder,          ///< datagrams arrive up to `amount_ns` later, out of order
  garbage,          ///< `count` random bytes between good frames, at the start and at the end
  unplug            ///< the serial line is absent
};

struct Step {
  TimeNs at_ns = 0;  ///< time since the start of the faults
  Fault fault = Fault::kill;
  Role target = Role::bridge;
  TimeNs for_ns = 0;
  TimeNs amount_ns = 0;
  std::uint32_t count = 0;

  bool operator==(const Step&) const = default;
};

enum class Line : std::uint8_t { serial, udp };

/// Additional output of the bridge.
enum class Disk : std::uint8_t { none, full, slow };

/// Share of the packets that a process loses when sending.
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
  std::vector<Step> steps;  ///< in order of time; steps on one target do not overlap

  bool operator==(const Plan&) const = default;
};

/// Draws the plan of this seed, always the same one.
Plan draw_plan(std::uint64_t seed, bool clock_steps = true);

/// Seeds whose plans cover every fault of bridge and fusions, both lines and both disks. Exceptions: an
/// unplugged line and a step of the bridge's clock.
inline constexpr std::array<std::uint64_t, 3> short_seeds{901, 1018, 1089};

/// Process whose clock the plan steps.
std::optional<Role> stepped_clock(const Plan& plan);

/// One-line description such as "serial, 2 fusions: 0.31 s kill fusion-300 for 0.42 s".
std::string text_of(const Plan& plan);
std::string text_of(const Step& step);
std::string text_of(Role role);

}  // namespace sonopose::faults
