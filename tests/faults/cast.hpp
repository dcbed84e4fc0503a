#pragma once
/// \file
/// The processes of a run and the line that feeds their bridge; plays the steps of a plan on them.

#include "faults/history.hpp"
#include "support/beacon_feed.hpp"
#include "support/bus.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/temporary_folder.hpp"
#include "support/udp_sender.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::faults {

/// Path of the library of Debian's package libfaketime; empty if not installed.
std::string faketime_library();

/// A serial line that can be unplugged, or a UDP port.
class FeedLine {
public:
  FeedLine(Line kind, std::filesystem::path device);

  void send(std::span<const std::uint8_t> bytes);
  void unplug();
  void plug();
  [[nodiscard]] test::Arguments bridge_options() const;

private:
  std::filesystem::path device_;
  std::mutex mutex_;
  std::optional<test::PseudoTerminal> terminal_;
  std::optional<test::UdpSender> sender_;
};

class Cast {
public:
  /// Starts all processes of the plan and returns when they are ready.
  Cast(const test::Bus& bus, const Plan& plan);
  Cast(const Cast&) = delete;
  Cast& operator=(const Cast&) = delete;
  ~Cast();

  /// Plays the steps at their times and waits until all processes are ready again.
  void play();

  /// Ends all processes. Returns a description of each process that ended wrongly, now or during the run.
  std::vector<std::string> finish();

  [[nodiscard]] std::vector<Episode> episodes() const { return episodes_; }
  [[nodiscard]] std::vector<Life> lives() const { return lives_; }

  static constexpr double imu_rate_hz = 200;
  static constexpr BeaconAddress first_address = 7;
  /// Address of the last beacon. SONOPOSE_FAULT_CROWD=1 makes it twenty beacons, and starts a monitor, a
  /// recorder, a ROS 2 relay and a live page, which are to survive.
  static BeaconAddress last_address();

private:
  void begin(const Step& step);
  void end(const Step& step);
  void start(Role role);
  void start_consumers();
  void wait_until_ready(Role role);
  void take_out(Role role, int signal);
  void step_clock(TimeNs offset_ns) const;
  void start_without_descriptors(std::uint32_t count);
  [[nodiscard]] test::Arguments arguments_of(Role role);
  [[nodiscard]] test::Environment environment_of(Role role) const;
  void join_restart(Role role);
  void drain(const std::stop_token& stop) const;

  const test::Bus& bus_;
  const Plan& plan_;
  test::TemporaryFolder folder_;
  int pipe_ = -1;  ///< pipe that acts as the slow disk
  int recordings_ = 0;
  FeedLine line_;
  test::BeaconFeed feed_;
  std::map<Role, std::unique_ptr<test::Process>> processes_;
  std::map<std::string, std::unique_ptr<test::Process>> consumers_;  ///< by program
  std::map<Role, std::thread> restarts_;
  std::vector<Episode> episodes_;  ///< each entry is written by one thread at a time
  std::mutex mutex_;               ///< guards the members below
  std::vector<Life> lives_;
  std::vector<std::string> failures_;
  std::jthread drain_;
};

}  // namespace sonopose::faults
