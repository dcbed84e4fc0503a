#pragma once
/// \file
/// Durations and times. Left out: the product and quotient of a duration.

#include "Exception.hpp"

#include <compare>
#include <cstdint>
#include <limits>

namespace dds::inline sonopose_psm::core {

namespace detail {

inline constexpr std::int64_t ns_per_s = 1'000'000'000;

/// Seconds and nanoseconds. Throws Error if a part is out of bounds.
template <class Value, std::int64_t min_s, std::int64_t max_s>
class SecondsAndNanoseconds {
public:
  std::int64_t sec() const noexcept { return sec_; }
  void sec(std::int64_t seconds) {
    if (seconds < min_s || seconds > max_s) throw Error("seconds out of bounds: " + std::to_string(seconds));
    sec_ = seconds;
  }
  std::uint32_t nanosec() const noexcept { return nanosec_; }
  void nanosec(std::uint32_t nanoseconds) {
    if (nanoseconds >= ns_per_s && nanoseconds != special) {
      throw Error("nanoseconds out of bounds: " + std::to_string(nanoseconds));
    }
    nanosec_ = nanoseconds;
  }

  static const Value from_microsecs(std::int64_t value) { return from_parts(value, 1'000'000); }
  static const Value from_millisecs(std::int64_t value) { return from_parts(value, 1'000); }
  static const Value from_secs(double seconds) {
    const auto whole = static_cast<std::int64_t>(seconds);
    return Value(whole, static_cast<std::uint32_t>((seconds - static_cast<double>(whole)) * 1e9));
  }

  std::int64_t to_millisecs() const { return ns() / 1'000'000; }
  std::int64_t to_microsecs() const { return ns() / 1'000; }
  double to_secs() const { return static_cast<double>(ns()) * 1e-9; }

  int compare(const Value& that) const { return *this < that ? -1 : *this > that ? 1 : 0; }
  // NOLINTNEXTLINE(modernize-use-nullptr): made by clang
  auto operator<=>(const SecondsAndNanoseconds&) const = default;

protected:
  static constexpr std::uint32_t special = 0x7fffffff;  ///< nanoseconds of invalid and infinite

  SecondsAndNanoseconds() = default;
  SecondsAndNanoseconds(std::int64_t seconds, std::uint32_t nanoseconds) {
    sec(seconds);
    nanosec(nanoseconds);
  }

  void set_invalid() {
    sec_ = -1;
    nanosec_ = special;
  }

  /// Nanoseconds as a number. Throws IllegalOperationError for an infinite or invalid value.
  std::int64_t ns() const {
    if (nanosec_ == special) throw IllegalOperationError("an infinite or invalid time is not a number");
    return sec_ * ns_per_s + nanosec_;
  }
  static Value from_ns(std::int64_t ns) {
    if (ns < 0) throw Error("a negative time: " + std::to_string(ns) + " ns");
    return Value(ns / ns_per_s, static_cast<std::uint32_t>(ns % ns_per_s));
  }

private:
  static Value from_parts(std::int64_t value, std::int64_t per_second) {
    return Value(value / per_second,
                 static_cast<std::uint32_t>(value % per_second * (ns_per_s / per_second)));
  }

  std::int64_t sec_ = 0;
  std::uint32_t nanosec_ = 0;
};

}  // namespace detail

/// A duration, not negative, up to 2^31 - 2 seconds or infinite.
class Duration : public detail::SecondsAndNanoseconds<Duration, 0, 0x7fffffff> {
public:
  static const Duration zero() { return Duration(); }
  static const Duration infinite() { return Duration(std::int64_t{0x7fffffff}, special); }

  Duration() = default;
  explicit Duration(std::int32_t seconds, std::uint32_t nanoseconds = 0)
      : SecondsAndNanoseconds(seconds, nanoseconds) {}
  explicit Duration(std::int64_t seconds, std::uint32_t nanoseconds = 0)
      : SecondsAndNanoseconds(seconds, nanoseconds) {}

  Duration& operator+=(const Duration& other) { return *this = from_ns(ns() + other.ns()); }
  Duration& operator-=(const Duration& other) { return *this = from_ns(ns() - other.ns()); }
  const Duration operator+(const Duration& other) const { return Duration(*this) += other; }
  const Duration operator-(const Duration& other) const { return Duration(*this) -= other; }
};

/// A time since the Unix epoch.
class Time
    : public detail::SecondsAndNanoseconds<Time, 0,
                                           std::numeric_limits<std::int64_t>::max() / detail::ns_per_s> {
public:
  static const Time invalid() {
    Time time;
    time.set_invalid();
    return time;
  }

  Time() = default;
  explicit Time(std::int64_t seconds, std::uint32_t nanoseconds = 0)
      : SecondsAndNanoseconds(seconds, nanoseconds) {}

  Time& operator+=(const Duration& duration) {
    return *this = from_ns(ns() + duration.sec() * detail::ns_per_s + duration.nanosec());
  }
  Time& operator-=(const Duration& duration) {
    return *this = from_ns(ns() - duration.sec() * detail::ns_per_s - duration.nanosec());
  }
};

inline const Time operator+(const Time& time, const Duration& duration) {
  return Time(time) += duration;
}
inline const Time operator+(const Duration& duration, const Time& time) {
  return Time(time) += duration;
}
inline const Time operator-(const Time& time, const Duration& duration) {
  return Time(time) -= duration;
}

namespace detail {
inline dds_duration_t to_c(const Duration& duration) {
  return duration == Duration::infinite() ? DDS_INFINITY : duration.sec() * ns_per_s + duration.nanosec();
}
inline Duration to_duration(dds_duration_t ns) {
  if (ns / ns_per_s >= Duration::infinite().sec()) return Duration::infinite();
  return Duration(ns / ns_per_s, static_cast<std::uint32_t>(ns % ns_per_s));
}
/// Throws InvalidArgumentError for an invalid time.
dds_time_t to_c(const Time& time);
inline Time to_time(dds_time_t time) {
  if (time < 0 || time == DDS_NEVER) return Time::invalid();
  return Time(time / ns_per_s, static_cast<std::uint32_t>(time % ns_per_s));
}
}  // namespace detail

}  // namespace dds::inline sonopose_psm::core
