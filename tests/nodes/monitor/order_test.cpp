#include "monitor/order.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace order_test {

using namespace sonopose;
using namespace sonopose::monitor;
using observation::BeaconView;

BeaconView view_of(BeaconAddress address, std::uint32_t status = 0) {
  BeaconView view;
  view.address = address;
  view.poses = 100;
  view.latency = {0.001, 0.002};
  view.pose.time_ns = 1'700'000'000'000'000'000;
  view.pose.status = status;
  return view;
}

Covariance<6> with_variance(double variance) {
  return Covariance<6>::from_matrix(variance * Covariance<6>::Matrix::Identity());
}

std::vector<int> addresses_of(const std::vector<BeaconView>& views) {
  std::vector<int> addresses;
  for (const BeaconView& view : views) addresses.push_back(view.address);
  return addresses;
}

SCENARIO("the worst beacon is the one that a consumer can rely on least") {
  GIVEN("beacons in all states") {
    BeaconView lost = view_of(6);
    lost.lost = true;
    BeaconView silent = view_of(5);
    silent.poses = 0;
    BeaconView imu_silent = view_of(4);
    imu_silent.fusion.emplace();
    imu_silent.fusion->imu_silent = true;
    std::vector<BeaconView> views{
        view_of(1), view_of(2, status_converging), view_of(3, status_stale), imu_silent, silent, lost};
    THEN("no pose precedes a wrong one, which precedes a doubtful one, which precedes a good one") {
      sort(views, Order::worst);
      CHECK(addresses_of(views) == std::vector{6, 5, 4, 3, 2, 1});
    }
    THEN("only a good one is without a fault; a predicted pose is no fault") {
      CHECK(severity_of(view_of(1)) == 0);
      CHECK(severity_of(view_of(1, status_predicted)) == 0);
      CHECK(severity_of(view_of(2, status_converging)) > 0);
      CHECK(severity_of(view_of(2, status_converging)) < bad_severity);
      CHECK(severity_of(view_of(3, status_stale | status_converging)) >= bad_severity);
      for (std::uint32_t bit = 1; bit != 0; bit <<= 1U) {
        if (bit != status_predicted) CHECK(severity_of(view_of(1, bit)) > 0);
      }
    }
  }
  GIVEN("beacons of which one has a trust that is no number") {
    std::vector<BeaconView> views{view_of(1), view_of(2), view_of(3)};
    views[0].pose.trust = std::numeric_limits<double>::quiet_NaN();
    views[1].pose.trust = 0.9;
    views[2].pose.trust = 0.1;
    THEN("it is last") {
      sort(views, Order::trust);
      CHECK(addresses_of(views) == std::vector{3, 2, 1});
    }
  }
  GIVEN("good beacons with errors that are measured, estimated and unknown") {
    BeaconView measured = view_of(1);
    measured.position_error_rms_m = 0.2;
    BeaconView estimated = view_of(2);
    estimated.pose.pose_covariance = with_variance(0.03);  // 0.3 m in 3D
    BeaconView unknown = view_of(3);
    unknown.pose.pose_covariance = with_variance(-1.0);
    std::vector<BeaconView> views{unknown, measured, estimated};
    THEN("the largest is first, the unknown last") {
      CHECK(error_m(measured) == 0.2);
      CHECK(error_m(estimated) == Approx(0.3));
      sort(views, Order::error);
      CHECK(addresses_of(views) == std::vector{2, 1, 3});
    }
  }
}

}  // namespace order_test
