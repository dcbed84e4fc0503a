#include "doctor/rules/checks.hpp"
#include "observation/beacon_observer.hpp"
#include <sonopose/estimation/aiding/twist_problem.hpp>
#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace sonopose::doctor::rules {
namespace {

using text::count_text;

/// Low battery. A Li-Po cell has about 10 % of its charge left at 3.5 V, and must stay above 3.0 V.
constexpr double low_battery_v = 3.5;
/// A few IMU periods. More jitter comes from a shared radio or a busy host.
constexpr double large_jitter_s = 0.030;
/// Limit above the latency on one host, and far above the error of synchronised clocks.
constexpr double large_clock_difference_s = 0.050;

/// The beacon's clock, unless its offset is one that a driver of ROS 2 must not have: its stamps are used as
/// they are, and the relay warns. A bridge maps the stamps of other beacons, whatever their clock shows.
std::string clock_text(const BeaconStatus& status) {
  constexpr double max_offset_s = 60;  // of a clock that is set
  constexpr double year_s = 365.25 * 86400;
  const double offset_s = status.clock_offset_s;
  if (std::abs(offset_s) < large_clock_difference_s) return fmt::format("clock offset {:.3f} s, ", offset_s);
  if (std::abs(offset_s) < max_offset_s) return {};
  const double beacon_s = seconds_between(0, status.time_ns) - offset_s;
  if (beacon_s < year_s) {
    return fmt::format("its clock is not set: it counts from its start, {} ago, ",
                       text::duration_text(std::max(0.0, beacon_s)));
  }
  return fmt::format("its clock is {} {}, ", text::duration_text(std::abs(offset_s)),
                     offset_s > 0 ? "behind" : "ahead");
}

class BeaconCheck {
public:
  BeaconCheck(const Observations& observations, const BeaconObservation& beacon, bool is_imu_right,
              Findings& findings)
      : observations_(observations),
        beacon_(beacon),
        is_imu_right_(is_imu_right),
        findings_(findings),
        fusion_lacks_imu_(no_fusion_receives_imu(observations)) {}

  void report_rates() const {
    std::string text =
        fmt::format("IMU {:.1f} Hz, fixes {:.1f} Hz, headings {:.1f} Hz, poses {:.1f} Hz",
                    beacon_.imu.rate_hz, beacon_.fix.rate_hz, beacon_.heading.rate_hz, beacon_.pose.rate_hz);
    if (beacon_.status && beacon_.status->battery_v) {
      text += fmt::format(", battery {:.2f} V", *beacon_.status->battery_v);
    }
    if (beacon_.status) {
      text += fmt::format(", {}jitter {:.1f} ms", clock_text(*beacon_.status),
                          beacon_.status->clock_jitter_s * 1e3);
    }
    add(Severity::ok, text, "");
  }

  void imu() const {
    if (beacon_.imu.samples == 0) {
      add(Severity::error, "no IMU samples received",
          "enable the stream of raw inertial data on the beacon, and check the output of sonopose-bridge");
    } else {
      check_silence(beacon_.imu, "IMU samples",
                    "check the line to the beacon; the lowest supported rate is 25 Hz");
    }
  }

  void fixes() const {
    if (beacon_.fix.samples > 0) {
      check_silence(beacon_.fix, "fixes", "check that the beacon receives its stationary beacons everywhere");
    } else if (increase_of(&BeaconStatus::fixes_unavailable) > 0) {
      add(Severity::warning, "no fixes received: the hardware flags its positions as not available",
          "check that the stationary beacons are awake, in line of sight, and in the same map as this "
          "beacon");
    } else {
      add(Severity::warning, "no fixes received",
          "wake the beacon up in the positioning system, and enable the stream of positions");
    }
  }

  void height() const {
    if (const auto& problem = beacon_.height_problem) add(Severity::warning, problem->text, problem->remedy);
  }

  void refused_fixes() const {
    constexpr double refused_share = 0.5;
    constexpr double min_refused_share = 0.1;
    constexpr double min_remedy_share = 0.25;
    const FixOutcomes& fixes = beacon_.fix_outcomes;
    const std::uint64_t refused =
        std::accumulate(fixes.refused.begin(), fixes.refused.end(), std::uint64_t{0});
    const auto share_of = [](std::uint64_t part, std::uint64_t all) {
      return static_cast<double>(part) / static_cast<double>(all);
    };
    if (refused < 2 || share_of(refused, fixes.reports) < min_refused_share) return;
    if (fusion_lacks_imu_ || !are_samples_right() || beacon_.imu.samples == 0) return;  // reported already
    std::vector<std::size_t> causes(fixes.refused.size());
    std::iota(causes.begin(), causes.end(), std::size_t{0});
    std::stable_sort(causes.begin(), causes.end(), [&fixes](std::size_t a, std::size_t b) {
      return fixes.refused.at(a) > fixes.refused.at(b);
    });
    std::string counts;
    std::string remedies;
    for (const std::size_t cause : causes) {
      const std::uint64_t count = fixes.refused.at(cause);
      if (count == 0) break;
      const auto [text, remedy] = refusal_texts(static_cast<FixRefusal>(cause));
      counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, text);
      if (share_of(count, refused) >= min_remedy_share) remedies += (remedies.empty() ? "" : "; ") + remedy;
    }
    add(share_of(refused, fixes.reports) > refused_share ? Severity::warning : Severity::note,
        fmt::format("its fusion refuses {} of its {}: {}", refused, count_text(fixes.reports, "fix", "fixes"),
                    counts),
        remedies);
  }

  void headings() const {
    const double mount_offset_deg = beacon_.fusion_settings.heading.mount_offset_deg;
    const std::uint64_t invalid_headings = beacon_.pair_headings - beacon_.valid_pair_headings;
    if (beacon_.pair_headings == 0 && beacon_.pair_fixes > 0) {
      add(Severity::warning, "no pair headings received, although its fixes are those of a pair",
          "switch the second beacon of the pair on, and enable the stream of positions with angle");
    } else if (beacon_.heading.samples == 0 && beacon_.fix.samples > 0 && mount_offset_deg != 0.0) {
      add(Severity::warning,
          fmt::format("no pair headings received, although heading.mount_offset_deg={} configures a pair",
                      mount_offset_deg),
          fmt::format(
              "pair the beacon and switch the second one on; for a single beacon, set mount_offset_deg = 0 "
              "in [beacon.{}.heading]",
              beacon_.address));
    } else if (beacon_.heading.samples == 0) {
      add(Severity::note, "no pair headings received: a single beacon estimates its heading from motion", "");
    } else if (2 * beacon_.valid_pair_headings < beacon_.pair_headings) {
      add(Severity::warning,
          fmt::format("{} of {} of the hardware {} invalid", invalid_headings,
                      count_text(beacon_.pair_headings, "pair heading"),
                      invalid_headings == 1 ? "is" : "are"),
          "check that both beacons of the pair have fixes, and that the pair's baseline is configured");
    } else {
      lost_headings();
    }
  }

  void velocities() const {
    if (beacon_.velocity_fault && are_samples_right()) {
      add(Severity::error, *beacon_.velocity_fault, "correct the velocities in their driver");
      return;
    }
    const EstimatorCounters counted{.twists_used = increase_of(&FusionStatus::velocities_used),
                                    .twists_rejected = increase_of(&FusionStatus::velocities_rejected),
                                    .twists_unused = increase_of(&FusionStatus::velocities_unused)};
    const auto problem = estimation::aiding::twist_problem(counted, beacon_.fusion_settings);
    if (!problem || fusion_lacks_imu_) return;
    add(problem->is_by_setting ? Severity::note : Severity::warning, "its " + problem->text, problem->remedy);
  }

  void poses(bool fusion_runs) const {
    const bool is_explained = fusion_lacks_imu_ || !is_imu_right_;
    if (!fusion_runs || beacon_.imu.samples == 0 || is_explained) return;  // reported already
    if (beacon_.pose.samples == 0) {
      add(Severity::error, "a fusion runs, but no poses of this beacon were received",
          "keep it still for a second, check that fixes arrive, and check the output of sonopose-fusion");
    } else if (constexpr double restart_s = 0.3; !follows(beacon_.pose, beacon_.imu, restart_s)) {
      check_silence(beacon_.pose, "poses", "check whether the machine of the fusion is overloaded");
    }
  }

  void two_bridges() const {
    if (beacon_.bridges.size() > 1) {
      std::string names;
      for (const ProcessObservation& bridge : beacon_.bridges)
        names += (names.empty() ? "" : ", ") + text_of(bridge);
      add(Severity::error,
          fmt::format("{} bridges publish it: {}; its poses are wrong", beacon_.bridges.size(), names),
          "stop all but one, or use different addresses");
    } else if (beacon_.status && beacon_.status->other_bridges > 0) {
      add(Severity::error,
          fmt::format("its bridge detects {}",
                      beacon_.status->other_bridges == 1
                          ? "another bridge that publishes it"
                          : fmt::format("{} other bridges that publish it", beacon_.status->other_bridges)),
          "stop all but one, or use different addresses");
    }
  }

  void standbys() const {
    if (beacon_.fusions.size() < 2 || !beacon_.fusion || !observation::serves(*beacon_.fusion)) return;
    add(Severity::ok,
        fmt::format("served by the fusion with strength {}, {} on standby", beacon_.fusion->strength,
                    beacon_.fusions.size() - 1),
        "");
  }

  void numbering() const {
    const bool has_other_bridge = beacon_.status && beacon_.status->other_bridges > 0;
    if (beacon_.bridges.size() > 1 || has_other_bridge) return;  // the counters below are a consequence
    if (beacon_.events_missing > 0) {
      add(by_share(beacon_.events_missing, beacon_.events_expected),
          fmt::format("{} of its {} not received", beacon_.events_missing,
                      count_text(beacon_.events_expected, "event was", "events were")),
          "check whether the network loses packets, or this machine is overloaded");
    }
    if (fusion_lacks_imu_) return;  // so are these
    if (const auto lost = increase_of(&FusionStatus::events_lost); lost > 0) {
      add(by_share(lost, beacon_.imu.samples), fmt::format("its fusion lost {}", count_text(lost, "event")),
          "check whether the network loses packets, or the machine of the fusion is overloaded");
    }
    if (const auto invalid = increase_of(&FusionStatus::samples_invalid);
        invalid > 0 && are_samples_right()) {
      // A bad line delivers some samples late.
      constexpr std::uint64_t one_in = 20;
      const bool is_frequent = invalid * one_in > beacon_.imu.samples + beacon_.fix.samples;
      add(is_frequent ? Severity::warning : Severity::note,
          fmt::format("its fusion rejected {}: not finite, out of range, out of order, or too late",
                      count_text(invalid, "sample")),
          "check for a second bridge, a clock that was set, or a faulty sensor");
    }
  }

  void clocks() const {
    if (!beacon_.status) return;
    if (beacon_.status->clock_jitter_s > large_jitter_s) {
      add(Severity::warning,
          fmt::format("its packets arrive with a jitter of {:.0f} ms", beacon_.status->clock_jitter_s * 1e3),
          "prefer USB to radio, and check whether the machine of the bridge is overloaded");
    }
    if (const auto resets = increase_of(&BeaconStatus::clock_resets); resets > 0) {
      add(Severity::warning,
          fmt::format("its clock was reset {}: the beacon restarted, or a clock was set",
                      count_text(resets, "time")),
          "check its power supply, and configure NTP to slew the host's clock instead of stepping it");
    }
  }

  void host_clock() const {
    if (!beacon_.bridge_ahead_s || std::abs(*beacon_.bridge_ahead_s) <= large_clock_difference_s) return;
    const double ahead_s = *beacon_.bridge_ahead_s;
    const bool same_host =
        beacon_.bridges.size() == 1 && beacon_.bridges.front().host == observations_.own_host;
    if (same_host && ahead_s < 0) {
      add(Severity::warning,
          fmt::format("its samples take {:.0f} ms to arrive, on the same machine", -ahead_s * 1e3),
          "check the load of this machine");
    } else {
      add(Severity::warning,
          fmt::format(
              "the clock of the bridge's machine is about {:.0f} ms {} the clock of this machine: latencies "
              "between the two are wrong by that much",
              std::abs(ahead_s) * 1e3, ahead_s > 0 ? "ahead of" : "behind"),
          "synchronise the machines' clocks (chrony, NTP, PTP)");
    }
  }

  void line() const {
    const auto crc_errors = increase_of(&BeaconStatus::crc_errors);
    const auto bytes_lost = increase_of(&BeaconStatus::bytes_lost);
    if (crc_errors > 0 || bytes_lost > 0) {
      add(Severity::warning,
          fmt::format("{} and {} on its line", count_text(crc_errors, "checksum error"),
                      count_text(bytes_lost, "lost byte")),
          "check cable and radio, and check that no other process reads the device");
    }
    const auto is_relay = [](const ProcessObservation& bridge) {
      return bridge.name.ends_with("sonopose-ros2");
    };
    const auto rejected = increase_of(&BeaconStatus::samples_rejected);
    if (rejected > 0 && std::ranges::any_of(beacon_.bridges, is_relay)) {
      add(Severity::warning,
          fmt::format("{} not used", count_text(rejected, "message of its ROS 2 drivers is",
                                                "messages of its ROS 2 drivers are")),
          "the log of sonopose-ros2 names topic and reason");
    } else if (rejected > 0) {
      add(Severity::warning,
          fmt::format("{} impossible values",
                      count_text(rejected, "of its samples has", "of its samples have")),
          "update the beacon's firmware, or replace it");
    }
    if (beacon_.status && beacon_.status->battery_v && *beacon_.status->battery_v < low_battery_v) {
      add(Severity::warning, fmt::format("its battery is at {:.2f} V", *beacon_.status->battery_v),
          "charge it: below 3.5 V a Li-Po cell is nearly empty");
    }
  }

private:
  void add(Severity severity, const std::string& what, const std::string& remedy) const {
    findings_.push_back({severity, name_of(beacon_), what, remedy});
  }

  /// False if wrong readings, or positions in another unit, explain what is refused.
  [[nodiscard]] bool are_samples_right() const {
    const auto is_unit = [](const motion::FixFault& fault) {
      return fault.kind == motion::FixFaultKind::unit;
    };
    return is_imu_right_ && std::none_of(beacon_.fix_faults.begin(), beacon_.fix_faults.end(), is_unit);
  }

  /// A cause for which fixes are refused, after their number, and its remedy.
  static std::pair<std::string, std::string> refusal_texts(FixRefusal cause) {
    constexpr const char* one_clock =
        "the stamps of fixes and IMU samples must come from one clock (sonopose-monitor shows their delay)";
    switch (cause) {
      case FixRefusal::low_quality:
        return {"of a quality below admission.min_quality_percent",
                "check the line of sight to the stationary beacons, or lower admission.min_quality_percent"};
      case FixRefusal::too_old:
        return {"too old (admission.max_fix_age_s)",
                fmt::format("{}, and the line must not delay fixes", one_clock)};
      case FixRefusal::too_new:
        return {"newer than the IMU samples", one_clock};
      case FixRefusal::no_imu:
        return {"before the first IMU sample", "check that IMU samples arrive before fixes"};
      case FixRefusal::invalid:
        break;
    }
    return {"repeated, out of order, not finite or out of range",
            "check for a second source of fixes, and for positions beyond admission.max_position_m"};
  }

  /// Note for up to one lost event in a hundred, otherwise warning.
  static Severity by_share(std::uint64_t lost, std::uint64_t events) {
    return lost * 100 > events ? Severity::warning : Severity::note;
  }

  /// Reports a pair, or another source of headings, that was lost for a part of the window.
  void lost_headings() const {
    constexpr const char* remedy =
        "check power and line of sight of the second beacon of the pair, and its distance to the first one";
    if (beacon_.pair_lost_s > 0) {
      add(Severity::warning,
          fmt::format("for about {:.0f} s, less than half of its fixes had a pair heading",
                      beacon_.pair_lost_s),
          remedy);
    } else if (beacon_.pair_headings == 0) {
      check_silence(beacon_.heading, "headings", "check their driver, and the output of sonopose-ros2");
    } else if (!follows(beacon_.heading, beacon_.fix)) {
      check_silence(beacon_.heading, "pair headings", remedy);
    }
  }

  /// True if the silence of a stream is that of its source, which is reported already. It may end later by
  /// `late_s`: an engine starts again with the next fix.
  static bool follows(const StreamObservation& stream, const StreamObservation& source,
                      double late_s = 0.05) {
    return source.longest_silence_s > source.deadline_s &&
           stream.longest_silence_s < source.longest_silence_s + late_s && stream.silences <= source.silences;
  }

  void check_silence(const StreamObservation& stream, const char* what, const char* remedy) const {
    if (stream.longest_silence_s <= stream.deadline_s) return;
    // Single pauses occur on a busy machine and are a note.
    constexpr std::uint64_t min_silences = 3;
    constexpr double share = 0.05;
    const bool are_many = stream.silences >= min_silences && stream.silent_s > share * observations_.window_s;
    const bool is_warning = stream.longest_silence_s > 3 * stream.deadline_s || are_many ||
                            stream.rate_hz * stream.deadline_s < 1;
    std::string text = fmt::format("no {} for {:.2f} s, which is longer than the deadline of {:.1f} s", what,
                                   stream.longest_silence_s, stream.deadline_s);
    if (stream.silences > 1) {
      text += fmt::format(" ({} such silences, {:.2f} s in total)", stream.silences, stream.silent_s);
    }
    add(is_warning ? Severity::warning : Severity::note, text, remedy);
  }

  /// Increase of a counter over the window; 0 if its process restarted.
  template <class Status>
  static std::uint64_t increase(const std::optional<Status>& before, const std::optional<Status>& after,
                                std::uint64_t Status::*counter) {
    if (!before || !after || (*after).*counter < (*before).*counter) return 0;
    return (*after).*counter - (*before).*counter;
  }
  [[nodiscard]] std::uint64_t increase_of(std::uint64_t BeaconStatus::*counter) const {
    return increase(beacon_.status_before, beacon_.status, counter);
  }
  [[nodiscard]] std::uint64_t increase_of(std::uint64_t FusionStatus::*counter) const {
    std::uint64_t sum = increase(beacon_.fusion_before, beacon_.fusion, counter);
    for (const FusionSpan& ended : beacon_.ended_fusions) {
      sum += increase<FusionStatus>(ended.before, ended.latest, counter);
    }
    return sum;
  }

  const Observations& observations_;
  const BeaconObservation& beacon_;
  bool is_imu_right_;
  Findings& findings_;
  bool fusion_lacks_imu_;  ///< reported already
};

}  // namespace

void check_beacon(const Observations& observations, const BeaconObservation& beacon, bool is_imu_right,
                  Findings& findings) {
  const BeaconCheck check(observations, beacon, is_imu_right, findings);
  check.report_rates();
  if (!on_topic(observations.writers, "sonopose/imu").empty()) {  // else missing streams are a consequence
    check.imu();
    check.fixes();
    check.refused_fixes();
    check.height();
    check.headings();
    check.velocities();
    check.poses(!on_topic(observations.writers, "sonopose/pose").empty());
  }
  check.two_bridges();
  check.standbys();
  check.numbering();
  check.clocks();
  check.host_clock();
  check.line();
}

}  // namespace sonopose::doctor::rules
