/// Fixes in ROS 2: each once, with the variance that the fusion assigns.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/psm/discovery.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sonopose::ros2_fix_test {

using namespace sonopose::test;
namespace topics = dds::topics;

struct SeenFix {
  TimeNs stamp_ns = 0;
  double variance_m2 = 0;
};

std::vector<SeenFix> fixes_seen(RosReader<ros2::PoseWithCovarianceStamped>& reader, std::size_t count) {
  std::vector<SeenFix> seen;
  REQUIRE(reader.wait_for_count(count, [&](const auto& message) {
    seen.push_back({stamp_of(message.header), message.pose.covariance[0]});
  }));
  return seen;
}

/// Returns true if `variance_m2` results from one of the standard deviations with one of the weights.
template <class Weights>
bool is_weighted(double variance_m2, const std::vector<double>& stds_m, const Weights& weights) {
  return std::any_of(stds_m.begin(), stds_m.end(), [&](double std_m) {
    return std::any_of(weights.first, weights.second, [&](const auto& weight) {
      return std::abs(variance_m2 * std::max(weight.second, 1e-4) / (std_m * std_m) - 1) < 1e-9;
    });
  });
}

SCENARIO("each fix arrives once, with the variance that the fusion assigns to it") {
  const std::string engine = GENERATE("documented", "kalman");
  GIVEN("a primary and a standby fusion, with fixes of 10 cm standard deviation by the settings") {
    const Bus bus;
    Consumer<sonopose_Estimate> estimates(bus, topics::estimate);
    Consumer<sonopose_UltrasonicFix> native(bus, topics::fix);
    Consumer<sonopose_FixReport> reports(bus, topics::report);
    RosReader<ros2::PoseWithCovarianceStamped> fix(bus, "/hedge_7/fix");
    const Arguments settings{"--set",
                             "documented.uncertainty.fix_std_m=0.1",
                             "--set",
                             "fusion.engine=" + engine,
                             "--warm-up",
                             "0",
                             "--standby-strength"};
    const auto with_strength = [&](const char* strength) {
      Arguments arguments = settings;
      arguments.emplace_back(strength);
      return bus.fusion(arguments);
    };
    const auto strong = with_strength("100");
    const auto weak = with_strength("50");
    const auto relay = bus.ros2();
    const auto bridge = bus.bridge({"--scenario", "walk"});
    THEN("each has the stamp of a native fix, no stamp twice, and the variance of its weight") {
      std::vector<SeenFix> seen;
      const auto weighted = [&] {
        native.take();
        estimates.take();
        reports.take();
        std::multimap<TimeNs, double> weights;
        for (const FixReport& report : reports.samples) {
          weights.emplace(report.emission_time_ns, report.weight);
        }
        std::vector<double> stds_m;
        if (engine == "documented") stds_m.push_back(0.1);
        for (const Estimate& estimate : estimates.samples) {
          if (estimate.fix_noise_m) stds_m.push_back(estimate.fix_noise_m->value);
        }
        return std::count_if(seen.begin(), seen.end(), [&](const SeenFix& one) {
          return is_weighted(one.variance_m2, stds_m, weights.equal_range(one.stamp_ns));
        });
      };
      // Other fixes precede the settings and estimates, or time out.
      const SteadyTime give_up = clocks::steady_now() + std::chrono::nanoseconds(timeout).count();
      for (std::size_t count = 4; weighted() < 12; count += 4) {
        REQUIRE(clocks::steady_now() < give_up);
        const auto more = fixes_seen(fix, count);
        seen.insert(seen.end(), more.begin(), more.end());
      }
      native.take();
      std::map<TimeNs, int> of_native;
      for (const UltrasonicFix& one : native.samples) of_native[one.emission_time_ns] = 0;
      for (const SeenFix& one : seen) {
        REQUIRE(of_native.contains(one.stamp_ns));
        CHECK(++of_native[one.stamp_ns] == 1);
      }
    }
  }
}

SCENARIO("fixes arrive without a fusion") {
  GIVEN("a bridge with two beacons, and a relay for one of them") {
    const Bus bus;
    RosReader<ros2::PoseWithCovarianceStamped> fix(bus, "/hedge_8/fix");
    const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
    const dds::Discovery discovery(participant);
    const auto relay = bus.ros2({"--addresses", "8"});
    const auto bridge = bus.bridge({"--beacons", "2"});
    THEN("they have full weight, and there is none of the other beacon") {
      for (const SeenFix& one : fixes_seen(fix, 3)) CHECK(one.variance_m2 == Approx(0.05 * 0.05));
      std::set<std::string> written;
      REQUIRE(wait_until([&] {
        for (const dds::FoundEndpoint& writer : discovery.writers()) written.insert(writer.topic_name);
        return written.contains("rt/hedge_8/fix");
      }));
      CHECK_FALSE(written.contains("rt/hedge_7/fix"));
    }
  }
}

SCENARIO("a beacon with a magnetometer has a magnetic field topic") {
  GIVEN("a relay, and a beacon with a magnetometer") {
    const Bus bus;
    const auto relay = bus.ros2();
    const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
    auto samples = dds::topics::make_writer(participant, dds::qos::Provider(), topics::imu);
    RosReader<ros2::MagneticField> field(bus, "/hedge_9/imu/mag", Subscription::sensor_data);
    ImuSample sample;
    sample.address = 9;
    sample.specific_force_body_mps2 = {0, 0, 9.81};
    sample.magnetic_field_body_t = Vector3d(20e-6, 1e-6, -40e-6);
    WHEN("its samples arrive") {
      ros2::Vector3 seen{};
      const bool came = wait_until([&] {
        ++sample.sequence;
        sample.sensor_time_ns = clocks::host_now();
        samples.write(dds::topics::to_idl(sample));
        return field.wait_for_count(
            1, [&](const auto& message) { seen = message.magnetic_field; }, std::chrono::milliseconds(10));
      });
      THEN("the field is published in tesla") {
        REQUIRE(came);
        CHECK(seen.x == 20e-6);
        CHECK(seen.z == -40e-6);
      }
    }
  }
}

}  // namespace sonopose::ros2_fix_test
