#pragma once
/// \file
/// The line under a cloud of arrivals: how a sender's clock runs against ours when all that is seen is when
/// its messages arrive.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonopose::marvelmind {

/// Fits the delay `arrival − beacon time` by the line that no arrival undercuts. Arrivals are only ever late,
/// so the earliest ones tell the clock, and however late the others come they do not move it. The earliest
/// arrival of each second is kept, for half a minute; the line is an edge of their lower convex hull. Bounded
/// work for each arrival, no allocation.
class LowerEnvelope {
public:
  /// Steeper than any quartz: beacons drift up to ±200 ppm.
  static constexpr double max_rate = 300e-6;
  /// Arrivals that for seconds come no nearer to the line than this have a new one; the old seconds are
  /// forgotten.
  static constexpr std::int64_t step_ns = 20'000'000;

  /// Takes one arrival. Beacon times must rise strictly.
  void add(std::int64_t beacon_ns, TimeNs arrival_ns);

  /// Forgets everything.
  void clear();

  bool empty() const { return size_ == 0; }

  /// Least delay, host − beacon, that a message sent at `beacon_ns` has. Zero before the first arrival.
  std::int64_t delay_ns(std::int64_t beacon_ns) const;

  /// How much faster the host's clock runs, as a ratio: +1e-6 is 1 ppm.
  double rate() const { return rate_; }

private:
  /// The earliest arrival of one second.
  struct Earliest {
    std::int64_t beacon_ns = 0;
    std::int64_t delay_ns = 0;
  };
  static constexpr std::size_t capacity = 32;
  static constexpr std::int64_t bucket_ns = 1'000'000'000;
  static constexpr std::size_t late_buckets_of_a_step = 5;
  static constexpr double min_span_for_rate_ns = 4e9;
  static constexpr double support = 0.75;  ///< where on the window the hull's edge is taken: nearer to now

  void open_bucket(const Earliest& first, TimeNs arrival_ns);
  void judge_closed_bucket();
  void keep_newest(std::size_t count);
  void fit();
  double hull_slope() const;

  std::array<Earliest, capacity> earliest_{};  ///< in order of time, the last one still open
  std::size_t size_ = 0;
  TimeNs bucket_start_ns_ = 0;     ///< arrival that opened the last bucket
  std::size_t late_in_a_row_ = 0;  ///< closed buckets that were later than the line by a step
  Earliest anchor_;                ///< a point on the line
  double rate_ = 0;
};

}  // namespace sonopose::marvelmind
