#pragma once
/// \file
/// Converts the packets of one beacon to samples.

#include "marvelmind/clock_set.hpp"
#include "marvelmind/packet.hpp"
#include "marvelmind/sink_ref.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace sonopose::marvelmind {

/// Counts samples made from one beacon's packets, and those withheld.
struct AssemblerCounters {
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes = 0;
  std::uint64_t imu_unavailable = 0;    ///< raw IMU packets without accelerometer or gyro
  std::uint64_t fixes_unavailable = 0;  ///< positions that the beacon flagged "not available"
  std::uint64_t samples_rejected = 0;   ///< implausible values
  std::uint64_t stamps_too_late = 0;    ///< those among them that are stamped in the year 2100 or later
  std::uint64_t duplicates = 0;         ///< measurements sent again, or in an older kind of packet
  /// Qualities that arrived after their fix had stopped waiting, or whose fix was not made.
  std::uint64_t quality_without_fix = 0;
};

/// Converts one beacon's packets to samples.
///
/// - A fix waits for its quality for at most `quality_wait_ns`; IMU samples overtake it meanwhile. The
///   quality, the next position packet or `flush` releases the fix, followed by its heading.
/// - Packets are kept until the clock has settled (a quarter of a second).
/// - A beacon may send one measurement in two kinds of packet (0x11 and 0x81, 0x03 and 0x83). The best kind
///   wins (unix time over uptime, millimetres over centimetres). The others are dropped as duplicates until
///   it has been silent for `generation_timeout_ns`. When a better kind appears, a fix close to the last
///   emission counts as a duplicate. An IMU stream that changes its kind may repeat one sample.
class BeaconAssembler {
public:
  static constexpr std::int64_t quality_wait_ns = 10'000'000;
  static constexpr std::int64_t generation_timeout_ns = 1'000'000'000;

  BeaconAssembler(std::uint8_t address, TimeMapping mapping);

  void on(const RawImu& imu, TimeNs arrival_ns, EventSink sink);
  void on(const Position& position, TimeNs arrival_ns, EventSink sink);
  void on(const Quality& quality, TimeNs arrival_ns, EventSink sink);
  void on(const Telemetry& telemetry);

  /// Emits samples whose waiting time is over at `now_ns`.
  void flush(TimeNs now_ns, EventSink sink);

  /// Emits all waiting samples. The clock settles on its observations so far.
  void finish(EventSink sink);

  /// Time at which `flush` is due if no packet arrives before.
  std::optional<TimeNs> next_deadline_ns() const;

  /// Passes a packet to the clock without making a sample. Returns its sending time in host time; empty until
  /// the clock has settled.
  std::optional<TimeNs> sent_host_ns(const ContentTime& sent, TimeNs arrival_ns);

  BeaconAddress address() const { return address_; }
  const AssemblerCounters& counters() const { return counters_; }
  ClockSteps clock_steps() const { return clocks_.steps(); }

  /// Battery, RSSI, clock and the counters of withheld samples; other fields stay at their defaults.
  BeaconStatus status() const;

private:
  /// A packet that waits for the clocks to settle.
  struct Arrived {
    std::variant<RawImu, Position, Quality> packet;
    TimeNs arrival_ns = 0;
  };

  /// A fix that waits for its quality, and its heading.
  struct Waiting {
    UltrasonicFix fix;
    PairHeading heading;
    TimeNs deadline_ns = 0;
  };

  /// The best kind of packet received for one type of measurement.
  struct PacketKindTracker {
    int rank = 0;
    TimeNs received_ns = 0;
    void on_packet(int rank, TimeNs arrival_ns);
    bool outranks(int rank, TimeNs arrival_ns) const;
  };

  void take(const Arrived& arrived, EventSink sink);
  void drain(EventSink sink);
  void release(EventSink sink);
  void expire(TimeNs now_ns, EventSink sink);
  void make(const RawImu& imu, TimeNs arrival_ns, EventSink sink);
  void make(const Position& position, TimeNs arrival_ns, EventSink sink);
  void make(const Quality& quality, TimeNs arrival_ns, EventSink sink);
  bool is_duplicate(const Position& position, TimeNs emission_ns) const;
  void observe(const ContentTime& sent, TimeNs arrival_ns);
  void reject(const Stamp& stamp);

  BeaconAddress address_;
  ClockSet clocks_;
  TimeBase newest_base_ = TimeBase::uptime_ms;  ///< time base of the newest sample
  std::vector<Arrived> pending_;                ///< packets kept until the clocks have settled
  std::optional<Waiting> waiting_;
  PacketKindTracker imu_generation_;
  PacketKindTracker position_generation_;
  std::optional<Position> last_position_;
  TimeNs last_emission_ns_ = 0;
  std::optional<double> battery_v_;
  std::optional<double> rssi_dbm_;
  AssemblerCounters counters_;
};

}  // namespace sonopose::marvelmind
