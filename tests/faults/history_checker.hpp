#pragma once
/// \file
/// Checks the data that a consumer received during a run against docs/reliability.md, "Faults".

#include "faults/history.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::faults {

struct Limits {
  TimeNs lease_ns = 100'000'000;    ///< lease of the pose's profile, and the IMU's deadline
  TimeNs silence_ns = 110'000'000;  ///< the lease plus 10 %
  /// Largest age of a pose without LATE since its sample left the bridge: LATE_AFTER plus 50 ms of transport.
  TimeNs age_ns = 300'000'000;
  TimeNs transit_ns = 260'000'000;         ///< the same when its sample leaves the bridge: LATE_AFTER
  TimeNs late_after_ns = 250'000'000;      ///< LATE_AFTER
  TimeNs prompt_transit_ns = 150'000'000;  ///< age at departure above which the bridge may have caused LATE
  TimeNs future_ns = 10'000'000;           ///< largest lead of a stamp over the host's clock
  TimeNs recovery_ns = 3'000'000'000;      ///< time to recover after the last fault
  TimeNs takeover_lag_ns = 50'000'000;     ///< largest difference in progress between fusions
  TimeNs unowned_lag_ns = 250'000'000;     ///< the same while no fusion serves
  /// Duration for which a step of the bridge's clock marks poses as late.
  TimeNs clock_step_late_ns = 4'000'000'000;
  /// Longest time that a fusion may wait for a sample if the bridge loses packets: several requests of 10 ms.
  TimeNs loss_ns = 50'000'000;
  /// Allowed number of a beacon's poses of unknown age, because the observer did not receive their samples.
  std::size_t unknown_ages = 10;
};

struct Verdict {
  std::vector<std::string> violations;
  TimeNs longest_silence_ns = 0;  ///< longest silence while a warm fusion and the bridge were alive
  TimeNs longest_age_ns = 0;      ///< largest age of a pose without LATE
  TimeNs recovery_ns = 0;
  TimeNs stalled_ns = 0;  ///< total time in which the machine stalled threads
  /// Poses without LATE whose stamps were older than the limit, also if the machine stalled threads.
  std::size_t old_poses = 0;
  std::size_t owner_changes = 0;
  std::uint64_t missing_counted = 0;
  std::uint64_t missing_uncounted = 0;
};

class HistoryChecker {
public:
  /// `history` must outlive the checker.
  explicit HistoryChecker(const History& history, const Limits& limits = {});

  Verdict check();

private:
  /// Data of one beacon.
  struct Track {
    std::vector<Arrival> poses;
    /// Poses checked for their age before their fusion was stopped and written after it; not in `poses`.
    std::vector<Arrival> in_hand;
    std::vector<Published> imu;
    std::map<TimeNs, std::size_t> index_of;  ///< index into `imu` by the bridge's time
  };

  void check_stamps(const Track& track);
  void check_ages(const Track& track);
  void check_stamp_ages(const Track& track);
  void check_future(const Track& track);
  void check_owners(const Track& track);
  void check_late(BeaconAddress address, const Track& track);
  [[nodiscard]] bool may_be_late(const Arrival& pose) const;
  void check_takeover_numbers(const Track& track);
  void check_numbers();
  void check_silence(BeaconAddress address, const Track& track);
  void check_recovery(BeaconAddress address, const Track& track);

  void violated(const Arrival& at, const std::string& text);
  [[nodiscard]] std::optional<Interval> stop_before(const Track& track, const Arrival& pose) const;
  [[nodiscard]] std::int32_t strength_of_process(const Arrival& pose) const;
  [[nodiscard]] std::string name_of(const Arrival& pose) const;
  [[nodiscard]] bool may_step_back(const Track& track, const Arrival& before, const Arrival& after) const;
  [[nodiscard]] bool may_weaken(const Track& track, const Arrival& before, const Arrival& after) const;
  [[nodiscard]] bool was_silent(const Track& track, SteadyTime from, SteadyTime until) const;
  [[nodiscard]] Interval wait_beside_bridge(const Track& track, SteadyTime from, SteadyTime until) const;
  [[nodiscard]] TimeNs gap_ns(const Track& track, Interval wait) const;
  [[nodiscard]] bool had_warm_fusion(BeaconAddress address, SteadyTime from, SteadyTime until) const;
  [[nodiscard]] bool had_episode(Role role, SteadyTime from, SteadyTime until) const;
  [[nodiscard]] bool loses(Role role) const;
  [[nodiscard]] TimeNs loss_ns() const;
  [[nodiscard]] std::optional<SteadyTime> published(const Track& track, const Arrival& pose) const;
  [[nodiscard]] std::uint64_t missing_between(const Track& track, const Arrival& before,
                                              const Arrival& after) const;
  [[nodiscard]] bool has_report_after(const Arrival& pose) const;
  [[nodiscard]] TimeNs stalled_ns(SteadyTime from, SteadyTime until) const;
  [[nodiscard]] TimeNs max_ahead_ns(SteadyTime now) const;
  [[nodiscard]] std::optional<Episode> bridge_clock_step() const;
  [[nodiscard]] std::optional<Interval> backward_stamps() const;

  const History& history_;
  Limits limits_;
  std::vector<Interval> stalls_;  ///< disjoint, in order of time
  std::map<BeaconAddress, Track> tracks_;
  Verdict verdict_;
};

}  // namespace sonopose::faults
