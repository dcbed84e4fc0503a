/// Packets lost, duplicated and delayed on a bad line, as seen by the bridge.

#include "sim/simulator.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>

namespace packet_loss_test {

using namespace sonopose;
using namespace sonopose::sim;

/// Stamps of the IMU samples that arrived.
struct ImuArrivals {
  std::map<TimeNs, int> copies;
  int late = 0;  ///< samples that arrived after a newer one
  TimeNs latest_ns = 0;
  double max_late_s = 0;
  bool copies_differ = false;
  std::map<TimeNs, ImuSample> first;

  void add(const ImuSample& imu) {
    const bool again = ++copies[imu.sensor_time_ns] > 1;
    if (again) {
      ImuSample same = imu;
      same.sequence = first.at(imu.sensor_time_ns).sequence;
      copies_differ = copies_differ || !(same == first.at(imu.sensor_time_ns));
      return;
    }
    first[imu.sensor_time_ns] = imu;
    if (imu.sensor_time_ns < latest_ns) {
      ++late;
      max_late_s = std::max(max_late_s, seconds_between(imu.sensor_time_ns, latest_ns));
    } else {
      latest_ns = imu.sensor_time_ns;
    }
  }
};

SCENARIO("a bad line loses, duplicates and delays IMU samples") {
  constexpr double duration_s = 600.0;
  constexpr double samples = 100.0 * duration_s;
  Simulator simulator(find_scenario("packet_loss"), {.duration_s = duration_s});
  ImuArrivals arrivals;
  TimeNs truth_ns = 0;
  std::size_t truths = 0;
  while (const auto step = simulator.next()) {
    const auto* imu = std::get_if<ImuSample>(&step->event);
    if (imu != nullptr) arrivals.add(*imu);
    if (!step->truth) continue;
    REQUIRE(imu != nullptr);
    CHECK(step->truth->time_ns == imu->sensor_time_ns);
    REQUIRE(step->truth->time_ns > truth_ns);  // in order and unique
    truth_ns = step->truth->time_ns;
    ++truths;
  }
  int twice = 0;
  for (const auto& [time_ns, copies] : arrivals.copies) {
    CHECK(copies <= 2);
    twice += copies == 2 ? 1 : 0;
  }
  THEN("1 % is lost singly and 0.45 % in runs, 1 % comes twice, 1 % comes late, by up to 50 ms") {
    const auto different = static_cast<double>(arrivals.copies.size());
    CHECK(1.0 - different / samples == Approx(0.0145).epsilon(0.2));
    CHECK(twice / samples == Approx(0.01).epsilon(0.2));
    CHECK(arrivals.late / samples == Approx(0.01).epsilon(0.2));
    CHECK(arrivals.max_late_s > 0.035);
    CHECK(arrivals.max_late_s <= 0.05 + 0.06);  // a packet followed by a run of losses waits for the next one
  }
  THEN("a copy differs only in its number") {
    CHECK_FALSE(arrivals.copies_differ);
  }
  THEN("late samples have no truth, all others have it once") {
    CHECK(truths + static_cast<std::size_t>(arrivals.late) == arrivals.copies.size());
  }
}

SCENARIO("a bad line affects the fix and the heading of a position packet together") {
  constexpr double duration_s = 1200.0;
  Simulator simulator(find_scenario("packet_loss"), {.duration_s = duration_s});
  std::map<TimeNs, int> fixes;
  std::map<TimeNs, int> headings;
  int late = 0;
  double max_late_s = 0;
  TimeNs last_received_ns = 0;
  TimeNs min_period_ns = 1'000'000'000;
  while (const auto step = simulator.next()) {
    if (const auto* fix = std::get_if<UltrasonicFix>(&step->event)) {
      CHECK(fix->received_time_ns >= last_received_ns);
      last_received_ns = fix->received_time_ns;
      CHECK(fix->measured_delay_s == seconds_between(fix->emission_time_ns, fix->received_time_ns));
      if (++fixes[fix->emission_time_ns] > 1) continue;
      const double late_s = *fix->measured_delay_s - 0.068;
      late += late_s > 0.04 ? 1 : 0;  // far beyond the jitter of 3 ms
      max_late_s = std::max(max_late_s, late_s);
    } else if (const auto* heading = std::get_if<PairHeading>(&step->event)) {
      ++headings[heading->emission_time_ns];
    }
  }
  TimeNs before_ns = 0;
  int twice = 0;
  for (const auto& [time_ns, copies] : fixes) {
    if (before_ns != 0) min_period_ns = std::min(min_period_ns, time_ns - before_ns);
    before_ns = time_ns;
    twice += copies == 2 ? 1 : 0;
  }
  const double emitted = duration_s * 1e9 / static_cast<double>(min_period_ns);
  THEN("10 % is lost singly and 2.25 % in runs, 5 % comes twice, 5 % comes late, by up to 0.3 s") {
    CHECK(1.0 - static_cast<double>(fixes.size()) / emitted == Approx(0.1225).epsilon(0.1));
    CHECK(twice / emitted == Approx(0.05).epsilon(0.15));
    CHECK(late / emitted == Approx(0.05).epsilon(0.15));
    CHECK(max_late_s > 0.28);
    CHECK(max_late_s < 0.32);
  }
  THEN("the headings are those of the fixes") {
    CHECK(headings == fixes);
  }
}

}  // namespace packet_loss_test
