#pragma once
/// \file
/// The line below a cloud of arrivals. It relates a sender's clock to the host's when only the arrival times
/// of its messages are known.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonopose::marvelmind {

/// Fits the delay `arrival − beacon time` by a line that no arrival undercuts. Arrivals can only be late, so
/// the earliest ones define the clock, and late ones do not affect it. Keeps the earliest arrival of each
/// second for half a minute; the line is an edge of their lower convex hull. Bounded work per arrival, no
/// allocation.
class LowerEnvelope {
public:
  /// Limit above the error of any quartz: beacons drift by up to ±200 ppm.
  static constexpr double max_rate = 300e-6;
  /// Distance above the line that restarts it without its older seconds, if arrivals stay further away for
  /// seconds.
  static constexpr std::int64_t step_ns = 20'000'000;

  /// Takes one arrival. Beacon times must rise strictly.
  void add(std::int64_t beacon_ns, TimeNs arrival_ns);

  void clear();

  bool empty() const { return size_ == 0; }

  /// The least delay, host − beacon, of a message sent at `beacon_ns`. Zero before the first arrival.
  std::int64_t delay_ns(std::int64_t beacon_ns) const;

  /// Relative excess rate of the host's clock: +1e-6 is 1 ppm.
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
  static constexpr double support = 0.75;  ///< position within the window at which the hull's edge is taken

  void open_bucket(const Earliest& first, TimeNs arrival_ns);
  void check_closed_bucket();
  void keep_newest(std::size_t count);
  void fit();
  double hull_slope() const;

  std::array<Earliest, capacity>
      earliest_{};  ///< earliest arrivals in order of time, the last one still open
  std::size_t size_ = 0;
  TimeNs bucket_start_ns_ = 0;     ///< arrival that opened the last bucket
  std::size_t late_in_a_row_ = 0;  ///< consecutive closed buckets that were later than the line by a step
  Earliest anchor_;                ///< a point on the line
  double rate_ = 0;
};

}  // namespace sonopose::marvelmind
