// The beacon clock: drift of the quartz, a busy line and restarts, and the accuracy of the mapped times.

#include "marvelmind/beacon_clock.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace beacon_clock_test {

using namespace sonopose;
using namespace sonopose::marvelmind;

constexpr TimeNs host_start_ns = 1'700'000'000'000'000'000;
constexpr double ns_per_s = 1e9;

/// A beacon that sends an IMU packet each period, and the line to the host.
struct Line {
  double drift = 0;  ///< relative excess of the beacon's clock rate
  double period_s = 0.01;
  double duration_s = 600;
  std::int64_t first_uptime_ms = 1000;
  std::function<double(double)> lateness_s = [](double) {
    return 0.0;
  };  ///< delay of a packet sent at this time
};

/// A packet with its mapped host time.
struct Mapped {
  double true_s = 0;  ///< time since the first packet
  std::int64_t uptime_ms = 0;
  double error_s = 0;  ///< mapped − true
  TimeNs host_ns = 0;
};

/// Runs a line through a clock. Packets arrive in order, so a late one delays its successors.
std::vector<Mapped> run(const Line& line, BeaconClock& clock) {
  std::vector<Mapped> mapped;
  TimeNs last_arrival_ns = 0;
  const auto count = static_cast<std::int64_t>(line.duration_s / line.period_s);
  for (std::int64_t i = 0; i < count; ++i) {
    const double wanted_s = static_cast<double>(i) * line.period_s;
    const auto uptime_ms = line.first_uptime_ms + std::llround(wanted_s * (1 + line.drift) * 1e3);
    const double true_s = static_cast<double>(uptime_ms - line.first_uptime_ms) * 1e-3 / (1 + line.drift);
    const TimeNs sent_ns = host_start_ns + to_ns(true_s);
    const TimeNs arrival_ns = std::max(sent_ns + to_ns(line.lateness_s(true_s)), last_arrival_ns);
    last_arrival_ns = arrival_ns;
    const Stamp stamp{TimeBase::uptime_ms, static_cast<std::uint32_t>(uptime_ms)};
    clock.observe(stamp, 0, arrival_ns);
    if (!clock.settled()) continue;
    const TimeNs host_ns = clock.host_ns(stamp);
    mapped.push_back({true_s, uptime_ms, seconds_between(sent_ns, host_ns), host_ns});
  }
  return mapped;
}

std::function<double(double)> exponential(double mean_s, unsigned seed) {
  return [random = std::mt19937_64(seed), jitter = std::exponential_distribution<double>(1 / mean_s)](
             double) mutable { return jitter(random); };
}

double worst_error_after(const std::vector<Mapped>& mapped, double from_s) {
  double worst = 0;
  for (const Mapped& m : mapped) {
    if (m.true_s >= from_s) worst = std::max(worst, std::abs(m.error_s));
  }
  return worst;
}

/// Worst relative error of the mapped intervals between neighbouring packets.
double worst_interval_error(const std::vector<Mapped>& mapped) {
  double worst = 0;
  for (std::size_t i = 1; i < mapped.size(); ++i) {
    const double beacon_s = static_cast<double>(mapped[i].uptime_ms - mapped[i - 1].uptime_ms) * 1e-3;
    const double host_s = seconds_between(mapped[i - 1].host_ns, mapped[i].host_ns);
    worst = std::max(worst, std::abs(host_s / beacon_s - 1));
  }
  return worst;
}

TEST_CASE("Ten minutes of drift and jitter: mapped times stay true, and intervals may be integrated over") {
  const double drift = GENERATE(-200e-6, -100e-6, 0.0, 100e-6, 200e-6);
  const unsigned seed = GENERATE(1U, 2U, 3U);
  BeaconClock clock;
  const auto mapped = run({.drift = drift, .lateness_s = exponential(5e-3, seed)}, clock);
  CAPTURE(drift, seed);
  REQUIRE(mapped.size() > 59000);
  CHECK(worst_error_after(mapped, 10) < 2e-3);
  CHECK(worst_error_after(mapped, 60) < 0.5e-3);
  CHECK(worst_interval_error(mapped) < 5e-3);
  CHECK(clock.resets() == 0);
  CHECK(clock.jitter_s() == Approx(5e-3).margin(2.5e-3));  // mean of the exponential distribution
}

TEST_CASE("Fixes alone, few and very late, still give a clock within what their jitter leaves open") {
  BeaconClock clock;
  const auto mapped = run({.drift = 100e-6, .period_s = 0.085, .lateness_s = exponential(20e-3, 4)}, clock);
  CHECK(worst_error_after(mapped, 30) < 8e-3);
  CHECK(worst_interval_error(mapped) < 5e-3);
  CHECK(clock.resets() == 0);
}

TEST_CASE("Packets that come in bursts are mapped to when they were made") {
  // A driver that delivers every 41.3 ms, which is no multiple of the beacon's 10, and stalls for 0.3 s every
  // 7 s.
  const auto bursts = [](double sent_s) {
    const double burst_s = std::ceil(sent_s / 0.0413) * 0.0413;
    const double since_hold_up_s = std::fmod(burst_s, 7.0);
    return burst_s - sent_s + (since_hold_up_s < 0.3 ? 0.3 - since_hold_up_s : 0.0);
  };
  BeaconClock clock;
  const auto mapped = run({.drift = -50e-6, .lateness_s = bursts}, clock);
  CHECK(worst_error_after(mapped, 10) < 2e-3);
  CHECK(worst_interval_error(mapped) < 5e-3);
  CHECK(clock.resets() == 0);
}

TEST_CASE("A host that reads nothing for ten seconds, and then all at once, has not seen a restart") {
  const auto pause = [](double sent_s) { return sent_s > 100 && sent_s < 110 ? 110 - sent_s : 0.0; };
  BeaconClock clock;
  const auto mapped = run({.drift = 100e-6, .duration_s = 200, .lateness_s = pause}, clock);
  CHECK(worst_error_after(mapped, 10) < 2e-3);
  CHECK(clock.resets() == 0);
}

TEST_CASE("What a port had stored before it was opened does not shift the clock") {
  // Old packets of half a second simultaneously, then each on time.
  const auto stored = [](double sent_s) { return sent_s < 0.5 ? 0.5 - sent_s : 0.0; };
  BeaconClock clock;
  const auto mapped = run({.duration_s = 60, .lateness_s = stored}, clock);
  CHECK(worst_error_after(mapped, 1) < 1e-3);
}

TEST_CASE("A backlog at the first contact gives no wrong time while it drains") {
  const double speed = GENERATE(1.5, 3.0, 10.0);  // packets a second, by those that are sent
  const auto draining = [&](double sent_s) { return std::max(0.0, 1.0 - sent_s * (1 - 1 / speed)); };
  BeaconClock clock;
  const auto mapped = run({.duration_s = 60, .lateness_s = draining}, clock);
  CAPTURE(speed);
  CHECK(worst_error_after(mapped, 0) < 0.025);
  CHECK(clock.resets() == 0);
  CHECK(mapped.front().true_s < 3.4);
}

TEST_CASE("The wrap of the ms counter goes unnoticed") {
  BeaconClock clock;
  const std::int64_t seconds_to_wrap = 30;
  const auto mapped = run({.drift = 100e-6,
                           .duration_s = 60,
                           .first_uptime_ms = (std::int64_t{1} << 32) - seconds_to_wrap * 1000,
                           .lateness_s = exponential(5e-3, 5)},
                          clock);
  REQUIRE(mapped.back().uptime_ms > std::int64_t{1} << 32);
  CHECK(worst_error_after(mapped, 10) < 2e-3);
  CHECK(worst_interval_error(mapped) < 5e-3);
  CHECK(clock.resets() == 0);
}

TEST_CASE("A line that becomes slower for good moves the clock smoothly") {
  const auto slower = [jitter = exponential(1e-3, 6)](double sent_s) mutable {
    return jitter(sent_s) + (sent_s > 60 ? 0.05 : 0.0);
  };
  BeaconClock clock;
  const auto mapped = run({.lateness_s = slower}, clock);
  CHECK(worst_interval_error(mapped) < 5e-3);
  CHECK(clock.resets() == 0);
  CHECK(mapped.back().error_s == Approx(0.05).margin(2e-3));  // a delay is indistinguishable from an offset
}

TEST_CASE("A permanent decrease of the delay moves the clock smoothly") {
  const auto quicker = [jitter = exponential(1e-3, 8)](double sent_s) mutable {
    return jitter(sent_s) + (sent_s < 60 ? 0.06 : 0.0);
  };
  BeaconClock clock;
  const auto mapped = run({.duration_s = 150, .lateness_s = quicker}, clock);
  CHECK(worst_interval_error(mapped) < 5e-3);
  CHECK(worst_error_after(mapped, 100) <
        0.3e-3);  // slewing 60 ms at 0.4 % takes 15 s, plus five time constants
  CHECK(clock.resets() == 0);
}

TEST_CASE("A beacon that restarts is detected, counted and mapped again") {
  const std::int64_t first_uptime_ms =
      GENERATE(50'000, 3'000'000'000);  // below and above half of the counter's range
  BeaconClock clock;
  run({.duration_s = 20, .first_uptime_ms = first_uptime_ms}, clock);
  REQUIRE(clock.settled());
  const TimeNs restart_ns = host_start_ns + to_ns(25.0);
  for (std::int64_t ms = 0; ms <= 300; ms += 10) {
    clock.observe({TimeBase::uptime_ms, 100 + ms}, 0, restart_ns + ms * 1'000'000);
  }
  CHECK(clock.resets() == 1);
  REQUIRE(clock.settled());
  CHECK(clock.host_ns({TimeBase::uptime_ms, 100}) == restart_ns);
}

TEST_CASE("A beacon's clock that leaps by more than a second is taken as restarted, a silence is not") {
  BeaconClock clock;
  run({.duration_s = 20}, clock);
  SECTION("it leaps forward while the host's goes on as ever") {
    clock.observe({TimeBase::uptime_ms, 21000 + 5000}, 0, host_start_ns + to_ns(20.0));
    CHECK(clock.resets() == 1);
  }
  SECTION("it stands still for five seconds") {
    for (int i = 0; i < 1000; ++i) {
      clock.observe({TimeBase::uptime_ms, 21000 + 10 * i}, 0, host_start_ns + to_ns(25.0 + 0.01 * i));
    }
    CHECK(clock.resets() == 1);
    CHECK(clock.host_ns({TimeBase::uptime_ms, 21000 + 9990}) == host_start_ns + to_ns(34.99));
  }
  SECTION("it was out of reach for an hour") {
    for (int i = 0; i < 3000; ++i) {
      clock.observe({TimeBase::uptime_ms, 3'621'000 + 10 * i}, 0, host_start_ns + to_ns(3620.0 + 0.01 * i));
    }
    CHECK(clock.resets() == 0);
    CHECK(clock.host_ns({TimeBase::uptime_ms, 3'650'990}) == host_start_ns + to_ns(3649.99));
  }
}

TEST_CASE("A line that becomes much quicker does not leave stamps in the future") {
  const double quicker_s = GENERATE(0.07, 0.3, 0.9, 5.0);
  CAPTURE(quicker_s);
  BeaconClock clock;
  run({.duration_s = 20}, clock);
  const auto true_ns = [quicker_s](int i) { return host_start_ns + to_ns(20.0 + 0.01 * i - quicker_s); };
  for (int i = 0; i < 100; ++i) {
    const Stamp stamp{TimeBase::uptime_ms, 21000 + 10 * i};
    clock.observe(stamp, 0, true_ns(i));
    if (i < 30) continue;  // it settles within a quarter of a second
    REQUIRE(clock.settled());
    CHECK(clock.host_ns(stamp) == true_ns(i));
  }
  CHECK(clock.resets() == 1);
}

TEST_CASE("An overtaken packet is mapped, and moves nothing") {
  BeaconClock clock;
  run({.duration_s = 20}, clock);
  const Stamp earlier{TimeBase::uptime_ms, 1000 + 19'900};
  const Stamp newest{TimeBase::uptime_ms, 1000 + 19'990};
  const TimeNs before_ns = clock.host_ns(newest);
  clock.observe(earlier, 0, host_start_ns + to_ns(20.05));
  CHECK(clock.host_ns(newest) == before_ns);
  CHECK(clock.host_ns(earlier) == host_start_ns + to_ns(19.9));
  CHECK(clock.resets() == 0);
}

TEST_CASE("The past of the mapping does not change when it is corrected") {
  BeaconClock clock;
  run({.drift = 200e-6, .duration_s = 5, .lateness_s = exponential(5e-3, 7)}, clock);
  const Stamp emission{TimeBase::uptime_ms, 5950};
  const TimeNs before_ns = clock.host_ns(emission);
  for (int i = 0; i < 20; ++i)
    clock.observe({TimeBase::uptime_ms, 6010 + 10 * i}, 0, host_start_ns + to_ns(5.01 + 0.01 * i));
  CHECK(clock.host_ns(emission) == before_ns);
}

TEST_CASE("Unix time of the modem's choosing and 1/64 s of old firmware are mapped alike") {
  const TimeNs zone_ns = to_ns(2 * 3600.0);  // local time sent as Unix time
  BeaconClock unix_clock;
  BeaconClock old_clock;
  for (std::int64_t i = 0; i < 500; ++i) {
    const TimeNs arrival_ns = host_start_ns + i * 125'000'000;
    unix_clock.observe({TimeBase::unix_ms, (arrival_ns + zone_ns) / 1'000'000}, 0, arrival_ns);
    old_clock.observe({TimeBase::uptime_64ths, 640 + 8 * i}, 0, arrival_ns);
  }
  const TimeNs last_ns = host_start_ns + 499 * TimeNs{125'000'000};
  CHECK(unix_clock.host_ns({TimeBase::unix_ms, (last_ns + zone_ns) / 1'000'000}) == last_ns);
  CHECK(unix_clock.offset_s() == Approx(-7200.0));
  CHECK(old_clock.host_ns({TimeBase::uptime_64ths, 640 + 8 * 499}) == last_ns);
}

TEST_CASE("The fixed clock knows the beacon's time alone") {
  FixedClock clock;
  const auto at = [&clock](std::int64_t uptime_ms, std::int64_t ahead_ms = 0) {
    const Stamp stamp{TimeBase::uptime_ms, static_cast<std::uint32_t>(uptime_ms)};
    clock.observe(stamp, ahead_ms * 1'000'000, host_start_ns);
    return (clock.host_ns(stamp) - host_start_ns) / 1'000'000;
  };
  SECTION("a position stamped before the IMU samples around it") {
    CHECK(at(5000) == 0);
    CHECK(at(5100) == 100);
    CHECK(at(5040, 68) == 40);
    CHECK(at(5110) == 110);
    CHECK(clock.resets() == 0);
  }
  SECTION("the wrap of the counter") {
    CHECK(at(0xFFFFFFFE) == 0);
    CHECK(at(0x100000003) == 5);
    CHECK(clock.resets() == 0);
  }
  SECTION("a restart goes on from the newest time") {
    at(5000);
    at(9000);
    CHECK(at(100) == 4000);
    CHECK(at(150) == 4050);
    CHECK(clock.resets() == 1);
  }
}

TEST_CASE("A clock that is set from 1970 to now while a file was written costs no time") {
  FixedClock clock;
  constexpr std::int64_t now_ms = 1'795'000'000'000;
  const auto at = [&clock](std::int64_t unix_ms, std::int64_t ahead_ms = 0) {
    const Stamp stamp{TimeBase::unix_ms, unix_ms};
    clock.observe(stamp, ahead_ms * 1'000'000, host_start_ns);
    return (clock.host_ns(stamp) - host_start_ns) / 1'000'000;
  };
  CHECK(at(5'000) == 0);
  CHECK(at(35'000) == 30'000);
  CHECK(at(now_ms) == 30'000);
  SECTION("the beacon goes on") {
    CHECK(at(now_ms + 10) == 30'010);
    CHECK(clock.resets() == 1);
  }
  SECTION("a position that was measured before is sent after it") {
    CHECK(at(34'990, 68) == 29'990);
    CHECK(at(now_ms + 20) == 30'020);
    CHECK(clock.resets() == 1);
  }
  SECTION("an hour without a packet is a pause") {
    CHECK(at(now_ms + 3'600'000) == 3'630'000);
    CHECK(clock.resets() == 1);
  }
}

TEST_CASE("A file whose clock is set while a position is under way has no gap") {
  FixedClock clock;
  constexpr std::int64_t now_ms = 1'795'000'000'000;
  const std::int64_t step_ms = GENERATE(-3'600'000, -10'000, -400, 400, 2'000, 10'000, 3'600'000);
  CAPTURE(step_ms);
  const auto observe = [&clock](std::int64_t unix_ms, std::int64_t ahead_ms = 0) {
    clock.observe({TimeBase::unix_ms, unix_ms}, ahead_ms * 1'000'000, host_start_ns);
  };
  const auto mapped_ms = [&clock](std::int64_t unix_ms) {
    return (clock.host_ns({TimeBase::unix_ms, unix_ms}) - host_start_ns) / 1'000'000;
  };
  for (std::int64_t ms = 0; ms <= 30'000; ms += 10) observe(now_ms + ms);
  observe(now_ms + 30'010 + step_ms);
  observe(now_ms + 30'020 + step_ms);
  observe(now_ms + 29'957, 68);  // a position that was measured before
  REQUIRE(clock.settled());
  CHECK(mapped_ms(now_ms + 29'957) == 29'957);
  CHECK(mapped_ms(now_ms + 30'010 + step_ms) == 30'000);  // the time between both clocks is unknown
  CHECK(mapped_ms(now_ms + 30'020 + step_ms) == 30'010);
  observe(now_ms + 30'080 + step_ms, 68);  // one of the new time
  CHECK(mapped_ms(now_ms + 30'080 + step_ms) == 30'070);
  CHECK(clock.steps() == 1);
  CHECK(std::abs(clock.newest_step_ns() - step_ms * 1'000'000) <= 10'000'000);
}

TEST_CASE("A clock of a file that is set back passes the stamp of a position that was under way") {
  FixedClock clock;
  constexpr std::int64_t now_ms = 1'795'000'000'000;
  const std::int64_t step_ms = GENERATE(400, 10'000);
  CAPTURE(step_ms);
  const auto at_ms = [&clock](std::int64_t unix_ms, std::int64_t ahead_ms = 0) {
    const Stamp stamp{TimeBase::unix_ms, unix_ms};
    clock.observe(stamp, ahead_ms * 1'000'000, host_start_ns);
    return (clock.host_ns(stamp) - host_start_ns) / 1'000'000;
  };
  for (std::int64_t ms = 0; ms <= 30'000; ms += 10) at_ms(now_ms + ms);
  std::int64_t newest_ms = at_ms(now_ms + 30'010 - step_ms);
  CHECK(at_ms(now_ms + 29'960, 68) == 29'960);
  REQUIRE(clock.steps() == 1);
  for (std::int64_t ms = 30'020 - step_ms; ms <= 31'000; ms += 10) {
    CAPTURE(ms);
    const std::int64_t mapped_ms = at_ms(now_ms + ms);
    REQUIRE(mapped_ms == newest_ms + 10);
    newest_ms = mapped_ms;
  }
}

TEST_CASE("A short loss of a file is no step, although the first position after it is late") {
  FixedClock clock;
  constexpr std::int64_t now_ms = 1'795'000'000'000;
  const std::int64_t loss_ms = GENERATE(260, 300);
  const std::int64_t late_ms = GENERATE(0, 130, 160, 200);
  CAPTURE(loss_ms, late_ms);
  const auto observe = [&clock](std::int64_t unix_ms, std::int64_t ahead_ms = 0) {
    clock.observe({TimeBase::unix_ms, unix_ms}, ahead_ms * 1'000'000, host_start_ns);
  };
  for (std::int64_t ms = 0; ms <= 30'000; ms += 10) observe(now_ms + ms);
  const std::int64_t sent_ms = now_ms + 30'000 + loss_ms;
  observe(sent_ms);
  observe(sent_ms - 68 - late_ms, 68);
  observe(sent_ms + 10);
  CHECK(clock.steps() == 0);
  CHECK(clock.host_ns({TimeBase::unix_ms, sent_ms + 10}) ==
        host_start_ns + to_ns(30.01) + loss_ms * 1'000'000);
}

TEST_CASE("A pause of a file is as long as the stamps say, and waits a quarter of a second for a position") {
  FixedClock clock;
  constexpr std::int64_t now_ms = 1'795'000'000'000;
  const auto observe = [&clock](std::int64_t unix_ms, std::int64_t ahead_ms = 0) {
    clock.observe({TimeBase::unix_ms, unix_ms}, ahead_ms * 1'000'000, host_start_ns);
  };
  for (std::int64_t ms = 0; ms <= 1'000; ms += 10) observe(now_ms + ms);
  observe(now_ms + 5'000);
  CHECK_FALSE(clock.settled());
  SECTION("IMU samples alone") {
    for (std::int64_t ms = 5'010; ms <= 5'250; ms += 10) observe(now_ms + ms);
  }
  SECTION("a position of after it") {
    observe(now_ms + 5'010, 68);
  }
  CHECK(clock.settled());
  CHECK(clock.host_ns({TimeBase::unix_ms, now_ms + 5'000}) == host_start_ns + to_ns(5.0));
  CHECK(clock.steps() == 0);
  CHECK(clock.resets() == 0);
}

TEST_CASE("A pause of a file is no step, although a position overtakes an IMU sample after it") {
  FixedClock clock;
  constexpr std::int64_t now_ms = 1'795'000'000'000;
  const auto observe = [&clock](std::int64_t unix_ms, std::int64_t ahead_ms = 0) {
    clock.observe({TimeBase::unix_ms, unix_ms}, ahead_ms * 1'000'000, host_start_ns);
  };
  observe(now_ms);
  observe(now_ms + 1000);
  observe(now_ms + 930, 60);
  observe(now_ms + 1010);
  CHECK(clock.steps() == 0);
}

TEST_CASE("A position that is under way while the clock of a live beacon is set maps no later stamp") {
  BeaconClock clock;
  constexpr std::int64_t set_ms = 1'795'000'000'000;
  TimeNs arrival_ns = host_start_ns;
  const auto send = [&](std::int64_t unix_ms, std::int64_t ahead_ns = 0) {
    clock.observe({TimeBase::unix_ms, unix_ms}, ahead_ns, arrival_ns);
    arrival_ns += 10'000'000;
  };
  for (std::int64_t ms = 30'000; ms < 33'000; ms += 10) send(ms);
  send(set_ms);
  send(32'940, 68'000'000);
  for (std::int64_t i = 1; i <= 40; ++i) send(set_ms + 10 * (i + 1));
  REQUIRE(clock.settled());
  CHECK(clock.host_ns({TimeBase::unix_ms, set_ms + 410}) == arrival_ns - 10'000'000);
  CHECK(clock.host_ns({TimeBase::unix_ms, set_ms + 20}) == arrival_ns - 400'000'000);
}

TEST_CASE("Garbage that jumps ahead in each stamp does not overflow a clock") {
  constexpr std::int64_t half_range = std::int64_t{1} << 31;
  FixedClock ahead;
  BeaconClock fitted;
  for (std::int64_t i = 0; i < 2000; ++i) {
    const Stamp stamp{TimeBase::uptime_64ths, (i * (half_range - 1)) & 0xFFFFFFFF};
    ahead.observe(stamp, 0, host_start_ns);
    fitted.observe(stamp, 0, host_start_ns + i * 1000);
  }
  CHECK(ahead.host_ns({TimeBase::uptime_64ths, 0}) > 0);  // an overflow would make it negative
}

TEST_CASE("A file whose clock jumps by decades again and again keeps its times in range") {
  FixedClock clock;
  constexpr std::int64_t year_2099_ms = 4'070'908'800'000;
  TimeNs newest_ns = host_start_ns;
  for (int i = 0; i < 10; ++i) {
    for (const std::int64_t ms : {std::int64_t{0}, year_2099_ms}) {
      const Stamp stamp{TimeBase::unix_ms, ms};
      REQUIRE(is_plausible(stamp));
      clock.observe(stamp, 0, host_start_ns);
      newest_ns = clock.host_ns(stamp);
      CHECK(newest_ns >= host_start_ns);  // an overflow would make it negative
    }
  }
  CHECK(clock.resets() == 19);  // each step but the first value
  SECTION("also those of a beacon whose first packet follows") {
    FixedClock second;
    for (const std::int64_t ms : {std::int64_t{0}, year_2099_ms}) {
      second.observe({TimeBase::unix_ms, ms}, 0, newest_ns);
      CHECK(second.host_ns({TimeBase::unix_ms, ms}) >= host_start_ns);
    }
  }
}

}  // namespace beacon_clock_test
