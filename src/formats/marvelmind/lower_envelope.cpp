#include "marvelmind/lower_envelope.hpp"

#include <algorithm>
#include <cmath>

namespace sonopose::marvelmind {

namespace {

double ns_between(std::int64_t from, std::int64_t to) {
  return static_cast<double>(to - from);
}

}  // namespace

void LowerEnvelope::clear() {
  *this = LowerEnvelope{};
}

std::int64_t LowerEnvelope::delay_ns(std::int64_t beacon_ns) const {
  return anchor_.delay_ns + std::llround(rate_ * ns_between(anchor_.beacon_ns, beacon_ns));
}

void LowerEnvelope::add(std::int64_t beacon_ns, TimeNs arrival_ns) {
  const Earliest arrival{beacon_ns, arrival_ns - beacon_ns};
  if (empty()) {
    open_bucket(arrival, arrival_ns);
    fit();
    return;
  }
  // Buckets follow the arrival time: a burst after a pause is one bucket, however old its packets are.
  const bool bucket_is_open = arrival_ns >= bucket_start_ns_ && arrival_ns < bucket_start_ns_ + bucket_ns;
  if (!bucket_is_open) {
    check_closed_bucket();
    fit();
    open_bucket(arrival, arrival_ns);
  } else if (arrival.delay_ns < earliest_[size_ - 1].delay_ns) {
    earliest_[size_ - 1] = arrival;
  }
  if (arrival.delay_ns < delay_ns(beacon_ns)) fit();
}

void LowerEnvelope::open_bucket(const Earliest& first, TimeNs arrival_ns) {
  if (size_ == capacity) keep_newest(capacity - 1);
  earliest_[size_++] = first;
  bucket_start_ns_ = arrival_ns;
}

/// Restarts if no arrival has approached the line for seconds: it is no longer the envelope.
void LowerEnvelope::check_closed_bucket() {
  const Earliest& closed = earliest_[size_ - 1];
  const bool late = closed.delay_ns - delay_ns(closed.beacon_ns) > step_ns;
  late_in_a_row_ = late ? late_in_a_row_ + 1 : 0;
  if (late_in_a_row_ < late_buckets_of_a_step) return;
  keep_newest(late_buckets_of_a_step);
  late_in_a_row_ = 0;
}

void LowerEnvelope::keep_newest(std::size_t count) {
  count = std::min(count, size_);
  const auto begin = earliest_.begin() + static_cast<std::ptrdiff_t>(size_ - count);
  std::copy(begin, begin + static_cast<std::ptrdiff_t>(count), earliest_.begin());
  size_ = count;
}

/// Finds the highest line at the point of support that no arrival of the window undercuts.
void LowerEnvelope::fit() {
  const double span_ns = ns_between(earliest_[0].beacon_ns, earliest_[size_ - 1].beacon_ns);
  if (span_ns >= min_span_for_rate_ns) rate_ = std::clamp(hull_slope(), -max_rate, max_rate);
  anchor_ = earliest_[size_ - 1];
  std::int64_t min_ns = anchor_.delay_ns;
  for (std::size_t i = 0; i < size_; ++i) {
    const auto& point = earliest_[i];
    const std::int64_t moved_on = std::llround(rate_ * ns_between(point.beacon_ns, anchor_.beacon_ns));
    min_ns = std::min(min_ns, point.delay_ns + moved_on);
  }
  anchor_.delay_ns = min_ns;
}

/// Returns the slope of the lower convex hull's edge (Andrew's monotone chain) above the point of support.
double LowerEnvelope::hull_slope() const {
  const Earliest& origin = earliest_[0];
  const auto x = [&](std::size_t i) { return ns_between(origin.beacon_ns, earliest_[i].beacon_ns); };
  const auto y = [&](std::size_t i) { return ns_between(origin.delay_ns, earliest_[i].delay_ns); };
  const auto slope = [&](std::size_t a, std::size_t b) { return (y(b) - y(a)) / (x(b) - x(a)); };

  std::array<std::size_t, capacity> hull{};
  std::size_t corners = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    while (corners >= 2 && slope(hull[corners - 2], hull[corners - 1]) >= slope(hull[corners - 1], i))
      --corners;
    hull[corners++] = i;
  }
  const double supported_at = support * x(size_ - 1);
  std::size_t edge = 1;
  while (edge + 1 < corners && x(hull[edge]) < supported_at) ++edge;
  return slope(hull[edge - 1], hull[edge]);
}

}  // namespace sonopose::marvelmind
