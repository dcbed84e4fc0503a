#pragma once
/// \file
/// The packets of one beacon → its samples.

#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>
#include "marvelmind/clock_set.hpp"
#include "marvelmind/event_sink.hpp"
#include "marvelmind/packet.hpp"

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace sonopose::marvelmind {

/// What was made of one beacon's packets, and what was kept back.
struct AssemblerCounters {
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes = 0;
  std::uint64_t imu_unavailable = 0;    ///< raw IMU packets without accelerometer or gyro
  std::uint64_t fixes_unavailable = 0;  ///< positions that the beacon flagged "not available"
  std::uint64_t samples_rejected = 0;   ///< values that no beacon can mean
  std::uint64_t duplicates = 0;         ///< the same measurement sent again, or in an older kind of packet
  std::uint64_t quality_without_fix =
      0;  ///< came later than a fix waits for it, or for a fix that was not made
};

/// Makes samples of one beacon's packets.
///
/// - A fix waits for its quality at most `quality_wait_ns`; IMU samples pass it meanwhile. It goes out with
/// the quality,
///   with the next position packet or by `flush`, and its heading right behind it.
/// - Until a fitted clock has settled (a quarter of a second), packets are held, not lost.
/// - A beacon may send one measurement in two kinds of packet (0x11 and 0x81, 0x03 and 0x83). The best
///   kind heard counts (unix time before uptime, millimetres before centimetres) and the others are dropped
///   as duplicates, until it has been silent for `generation_timeout_ns`. When a better kind sets in, a fix
///   close to the last one's emission is that one again. An IMU stream that changes its kind under way may
///   repeat one sample.
class BeaconAssembler {
public:
  static constexpr std::int64_t quality_wait_ns = 10'000'000;
  static constexpr std::int64_t generation_timeout_ns = 1'000'000'000;

  BeaconAssembler(std::uint8_t address, TimeMapping mapping);

  void on(const RawImu& imu, TimeNs arrival_ns, EventSink sink);
  void on(const Position& position, TimeNs arrival_ns, EventSink sink);
  void on(const Quality& quality, TimeNs arrival_ns, EventSink sink);
  void on(const Telemetry& telemetry);

  /// Lets time pass: hands out what has waited long enough.
  void flush(TimeNs now_ns, EventSink sink);

  /// Hands out all that waits. The clock settles with what it has seen.
  void finish(EventSink sink);

  /// When `flush` has something to do at the latest, if nothing comes until then.
  std::optional<TimeNs> next_deadline_ns() const;

  /// Shows the clock a packet without making a sample of it. Its sending in host time, if that can be told
  /// yet.
  std::optional<TimeNs> sent_host_ns(const ContentTime& sent, TimeNs arrival_ns);

  BeaconAddress address() const { return address_; }
  const AssemblerCounters& counters() const { return counters_; }

  /// Battery, rssi, clock and the counters of what was kept back; the rest is not known here.
  BeaconStatus status() const;

private:
  /// A packet on its way into samples.
  struct Arrived {
    std::variant<RawImu, Position, Quality> packet;
    TimeNs arrival_ns = 0;
  };

  /// A fix that waits for its quality, and the heading behind it.
  struct Waiting {
    UltrasonicFix fix;
    PairHeading heading;
    TimeNs deadline_ns = 0;
  };

  /// The best kind of packet heard for one sort of measurement.
  struct Generation {
    int rank = 0;
    TimeNs heard_ns = 0;
    void hear(int rank, TimeNs arrival_ns);
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
  void show_clocks(const ContentTime& sent, TimeNs arrival_ns);

  BeaconAddress address_;
  ClockSet clocks_;
  TimeBase newest_base_ = TimeBase::uptime_ms;  ///< of the newest sample
  std::vector<Arrived> held_;                   ///< until the clocks have settled
  std::optional<Waiting> waiting_;
  Generation imu_generation_;
  Generation position_generation_;
  std::optional<Position> last_position_;
  TimeNs last_emission_ns_ = 0;
  std::optional<double> battery_v_;
  std::optional<double> rssi_dbm_;
  AssemblerCounters counters_;
};

}  // namespace sonopose::marvelmind
