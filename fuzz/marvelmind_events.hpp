#pragma once
/// \file
/// The promises of the assembler about its events.

#include "marvelmind/assembler.hpp"
#include "support.hpp"
#include <sonopose/samples/samples.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <variant>

namespace sonopose::fuzz {

/// A sink that checks events.
class EventCheck {
public:
  /// Counts a packet. Call it before the assembler gets one.
  void packet() { ++packets_; }

  void operator()(const Event& event) {
    ++events_;
    promise(address_of(event) <= 0xFF, "an address of the wire has one byte");
    std::visit([](const auto& sample) { check(sample); }, event);
  }

  void finish(const marvelmind::Assembler& assembler) const {
    promise(events_ <= 2 * packets_, "a packet gives at most a fix and its heading");
    promise(assembler.addresses().size() <= packets_, "each beacon has sent a packet");
    for (const BeaconAddress address : assembler.addresses()) {
      const BeaconStatus status = assembler.beacon(address)->status();
      promise(std::isfinite(status.clock_offset_s) && std::isfinite(status.clock_jitter_s),
              "the clock of a beacon is finite");
    }
  }

private:
  static void check(const ImuSample& imu) {
    promise(imu.angular_velocity_body_radps.allFinite() && imu.specific_force_body_mps2.allFinite(),
            "an IMU sample is finite");
    promise(!imu.magnetic_field_body_t || imu.magnetic_field_body_t->allFinite(),
            "a magnetic field is finite");
  }
  static void check(const UltrasonicFix& fix) {
    constexpr double max_m = 10'000;
    promise(fix.position_world_m.cwiseAbs().maxCoeff() <= max_m, "a fix is within 10 km");
    promise(!fix.quality_percent || (*fix.quality_percent >= 0 && *fix.quality_percent <= 100),
            "a quality is a percentage");
    promise(!fix.measured_delay_s || (*fix.measured_delay_s > 0 && *fix.measured_delay_s < 66),
            "a delay has 16 bits of milliseconds");
  }
  static void check(const PairHeading& heading) {
    promise(!heading.valid ||
                (heading.heading_world_rad >= 0 && heading.heading_world_rad < 2 * std::numbers::pi + 1e-9),
            "a heading is less than a turn");
  }

  static void check(const TwistSample& /*twist*/) { promise(false, "no packet has a velocity"); }

  std::uint64_t packets_ = 0;
  std::uint64_t events_ = 0;
};

}  // namespace sonopose::fuzz
