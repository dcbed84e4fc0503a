#include "doctor/rules/rules.hpp"
#include "observation/beacon_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sonopose::doctor::doctor {
namespace {

/// A Li-Po cell has about a tenth of its charge left at 3.5 V, and must not be drawn below 3.0 V.
constexpr double low_battery_v = 3.5;
/// Arrivals that spread more than a few IMU periods: a shared radio, or a host that is busy.
constexpr double large_jitter_s = 0.030;
/// Between hosts; above what a chain on one host takes, and far above synchronised clocks.
constexpr double large_clock_difference_s = 0.050;

class Look {
public:
  Look(const Observations& seen, const BeaconObservation& beacon, Findings& findings)
      : seen_(seen), beacon_(beacon), findings_(findings) {}

  void rates() const {
    std::string text =
        fmt::format("IMU {:.1f} Hz, fixes {:.1f} Hz, headings {:.1f} Hz, poses {:.1f} Hz",
                    beacon_.imu.rate_hz, beacon_.fix.rate_hz, beacon_.heading.rate_hz, beacon_.pose.rate_hz);
    if (beacon_.status && beacon_.status->battery_v) {
      text += fmt::format(", battery {:.2f} V", *beacon_.status->battery_v);
    }
    if (beacon_.status) {
      text += fmt::format(", clock offset {:.3f} s, jitter {:.1f} ms", beacon_.status->clock_offset_s,
                          beacon_.status->clock_jitter_s * 1e3);
    }
    add(Severity::ok, text, "");
  }

  void imu() const {
    if (beacon_.imu.samples == 0) {
      add(Severity::error, "no IMU sample came",
          "let the beacon stream raw inertial data, and look at what sonopose-bridge says");
    } else {
      silence(beacon_.imu, "IMU samples",
              "25 Hz is the slowest that is supported; look at the line to the beacon");
    }
  }

  void fixes() const {
    if (beacon_.fix.samples > 0) {
      silence(beacon_.fix, "fixes", "see that the beacon hears its stationary beacons everywhere");
    } else if (rising(&BeaconStatus::fixes_unavailable) > 0) {
      add(Severity::warning, "no fix came: the hardware flags its positions as not available",
          "see that the stationary beacons are awake, in sight, and in one map with this one");
    } else {
      add(Severity::warning, "no fix came",
          "wake the beacon up in the positioning system, and let it stream positions");
    }
  }

  void headings() const {
    if (beacon_.heading.samples == 0) {
      add(Severity::note, "no pair heading came: a single beacon learns its heading by moving", "");
    } else if (beacon_.valid_headings == 0) {
      add(Severity::warning, "the hardware knows no heading of the pair",
          "see that both beacons of the pair have fixes, and that the pair's base is set");
    }
  }

  void poses(bool fusion_runs) const {
    if (!fusion_runs || beacon_.imu.samples == 0 || fusion_is_deaf()) return;  // told already
    if (beacon_.pose.samples == 0) {
      add(Severity::error, "a fusion runs, but no pose of this beacon came",
          "hold it still for a second, and see that fixes come; look at what sonopose-fusion says");
    } else {
      silence(beacon_.pose, "poses", "see whether the fusion's machine is overloaded");
    }
  }

  void two_bridges() const {
    if (beacon_.bridges.size() > 1) {
      std::string names;
      for (const ProcessObservation& bridge : beacon_.bridges)
        names += (names.empty() ? "" : ", ") + text_of(bridge);
      add(Severity::error,
          fmt::format("{} bridges publish it: {}; its poses are wrong", beacon_.bridges.size(), names),
          "stop all but one, or give them other addresses");
    } else if (beacon_.status && beacon_.status->other_bridges > 0) {
      add(Severity::error,
          fmt::format("its bridge sees {} more that publish it", beacon_.status->other_bridges),
          "stop all but one, or give them other addresses");
    }
  }

  void standbys() const {
    if (beacon_.fusions.size() < 2 || !beacon_.fusion || !observation::serves(*beacon_.fusion)) return;
    const auto rivals =
        std::count_if(beacon_.fusions.begin(), beacon_.fusions.end(), [this](const FusionStatus& fusion) {
          return observation::serves(fusion) && fusion.strength == beacon_.fusion->strength;
        });
    if (rivals > 1) {
      add(Severity::warning,
          fmt::format("{} fusions of the same strength {} serve it: which of them is heard is chance", rivals,
                      beacon_.fusion->strength),
          "give each another --standby-strength (docs/standby.md)");
    } else {
      add(Severity::ok,
          fmt::format("served by the fusion of strength {}, {} more stand by", beacon_.fusion->strength,
                      beacon_.fusions.size() - 1),
          "");
    }
  }

  void numbering() const {
    if (beacon_.events_missing > 0 && beacon_.bridges.size() < 2) {
      add(by_share(beacon_.events_missing),
          fmt::format("{} of its events did not come here", beacon_.events_missing),
          "see whether a network in between loses packets, or this machine is overloaded");
    }
    if (fusion_is_deaf()) return;  // what it counts follows from that
    if (const auto lost = rising(&FusionStatus::events_lost); lost > 0) {
      add(by_share(lost), fmt::format("its fusion lost {} events", lost),
          "see whether a network in between loses packets, or the fusion's machine is overloaded");
    }
    if (const auto invalid = rising(&FusionStatus::samples_invalid); invalid > 0) {
      add(Severity::warning,
          fmt::format("its fusion refused {} samples: not finite, absurd, or backward in time", invalid),
          "look for a second bridge, a clock that was set, or a faulty sensor");
    }
  }

  void clocks() const {
    if (!beacon_.status) return;
    if (beacon_.status->clock_jitter_s > large_jitter_s) {
      add(Severity::warning,
          fmt::format("its packets arrive with a spread of {:.0f} ms", beacon_.status->clock_jitter_s * 1e3),
          "prefer USB to radio, and see whether the bridge's machine is overloaded");
    }
    if (const auto resets = rising(&BeaconStatus::clock_resets); resets > 0) {
      add(Severity::warning,
          fmt::format("its clock began anew {} times: the beacon restarted, or a clock was set", resets),
          "look at its power supply, and let NTP slew the host's clock rather than set it");
    }
  }

  void host_clock() const {
    if (!beacon_.bridge_ahead_s || std::abs(*beacon_.bridge_ahead_s) <= large_clock_difference_s) return;
    const double ahead_s = *beacon_.bridge_ahead_s;
    const bool same_host = beacon_.bridges.size() == 1 && beacon_.bridges.front().host == seen_.own_host;
    if (same_host) {
      add(Severity::warning,
          fmt::format("its samples are {:.0f} ms old when they come here, on one machine", -ahead_s * 1e3),
          "see what keeps this machine busy");
    } else {
      add(Severity::warning,
          fmt::format(
              "the clock of its bridge's machine is about {:.0f} ms {} this one's: ages and latencies that "
              "are read across machines are off by that",
              std::abs(ahead_s) * 1e3, ahead_s > 0 ? "ahead of" : "behind"),
          "synchronise the machines' clocks (chrony, NTP, PTP)");
    }
  }

  void line() const {
    const auto crc_errors = rising(&BeaconStatus::crc_errors);
    const auto bytes_lost = rising(&BeaconStatus::bytes_lost);
    if (crc_errors > 0 || bytes_lost > 0) {
      add(Severity::warning,
          fmt::format("{} frames with a wrong check sum, {} bytes lost on its line", crc_errors, bytes_lost),
          "look at cable and radio, and see that nobody else reads the device");
    }
    if (const auto rejected = rising(&BeaconStatus::samples_rejected); rejected > 0) {
      add(Severity::warning, fmt::format("{} of its values are such as no sensor can give", rejected),
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

  /// How bad it is that so many events are lost: up to one in a hundred is a note.
  [[nodiscard]] Severity by_share(std::uint64_t lost) const {
    return lost * 100 > beacon_.imu.samples ? Severity::warning : Severity::note;
  }

  /// Whether a reader of IMU samples does not match, which has been told.
  [[nodiscard]] bool fusion_is_deaf() const {
    return std::any_of(findings_.begin(), findings_.end(), [](const Finding& finding) {
      return finding.severity == Severity::error && finding.subject == "sonopose/imu";
    });
  }

  void silence(const StreamObservation& stream, const char* what, const char* remedy) const {
    if (stream.longest_silence_s <= stream.deadline_s) return;
    // One hiccup of a busy machine is no more than worth a note.
    const bool bad =
        stream.longest_silence_s > 3 * stream.deadline_s || stream.rate_hz * stream.deadline_s < 1;
    add(bad ? Severity::warning : Severity::note,
        fmt::format("no {} for {:.2f} s, which is longer than the deadline of {:.1f} s", what,
                    stream.longest_silence_s, stream.deadline_s),
        remedy);
  }

  /// How much a counter rose over the window; 0 where its process began anew.
  template <class Status>
  static std::uint64_t rise(const std::optional<Status>& before, const std::optional<Status>& after,
                            std::uint64_t Status::*counter) {
    if (!before || !after || (*after).*counter < (*before).*counter) return 0;
    return (*after).*counter - (*before).*counter;
  }
  [[nodiscard]] std::uint64_t rising(std::uint64_t BeaconStatus::*counter) const {
    return rise(beacon_.status_before, beacon_.status, counter);
  }
  [[nodiscard]] std::uint64_t rising(std::uint64_t FusionStatus::*counter) const {
    return rise(beacon_.fusion_before, beacon_.fusion, counter);
  }

  const Observations& seen_;
  const BeaconObservation& beacon_;
  Findings& findings_;
};

}  // namespace

void check_beacon(const Observations& seen, const BeaconObservation& beacon, Findings& findings) {
  const Look look(seen, beacon, findings);
  look.rates();
  if (!on_topic(seen.writers, "sonopose/imu").empty()) {  // without a bridge all the rest follows from that
    look.imu();
    look.fixes();
    look.headings();
    look.poses(!on_topic(seen.writers, "sonopose/pose").empty());
  }
  look.two_bridges();
  look.standbys();
  look.numbering();
  look.clocks();
  look.host_clock();
  look.line();
}

}  // namespace sonopose::doctor::doctor
