#include "web/metrics.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <iostream>

namespace metrics_test {

using namespace sonopose;
using namespace sonopose::web;
using Catch::Contains;

constexpr TimeNs now_ns = 1'700'000'000'500'000'000;

observation::BeaconView view_of(BeaconAddress address) {
  observation::BeaconView view;
  view.address = address;
  view.poses = 100;
  view.pose_rate_hz = 100;
  view.latency = {.p50_s = 0.0002, .p99_s = 0.001};
  view.pose.time_ns = now_ns - 250'000'000;
  view.pose.status = status_stale;
  view.bridge.emplace().battery_v = 3.75;
  view.bridge->other_bridges = 1;
  view.fusion.emplace().fixes_used = 3;
  view.fusion->fixes_rejected = 1;
  view.report.emplace().innovation_world_m = {0.3, 0.4, 0.0};
  return view;
}

SCENARIO("each metric has a row for each beacon that knows it") {
  observation::BeaconView unknown;
  unknown.address = 9;
  const std::string text = metrics_text({view_of(7), unknown}, now_ns);
  CHECK_THAT(text, Contains("# TYPE sonopose_pose_rate_hz gauge\n"
                            "sonopose_pose_rate_hz{beacon=\"7\"} 100\n"
                            "sonopose_pose_rate_hz{beacon=\"9\"} 0\n"));
  CHECK_THAT(text, Contains("sonopose_pose_latency_p99_seconds{beacon=\"7\"} 0.001\n"));
  CHECK_THAT(text, Contains("sonopose_pose_age_seconds{beacon=\"7\"} 0.25\n"));
  CHECK_THAT(text, Contains("sonopose_pose_status{beacon=\"7\",condition=\"stale\"} 1\n") &&
                       Contains("sonopose_pose_status{beacon=\"7\",condition=\"late\"} 0\n"));
  CHECK_THAT(text, Contains("sonopose_fix_innovation_meters{beacon=\"7\"} 0.5\n"));
  CHECK_THAT(text, Contains("sonopose_fixes_used_ratio{beacon=\"7\"} 0.75\n"));
  CHECK_THAT(text, Contains("sonopose_battery_volts{beacon=\"7\"} 3.75\n"));
  CHECK_THAT(text, Contains("sonopose_bridge_other_bridges{beacon=\"7\"} 1\n"));
  CHECK_THAT(text, Contains("sonopose_fusion_fixes_used_total{beacon=\"7\"} 3\n"));
  CHECK_THAT(text, !Contains("sonopose_pose_age_seconds{beacon=\"9\"}"));
  CHECK_THAT(text, !Contains("enclave"));
  CHECK_THAT(metrics_text({}, now_ns, {{"web", 1'800'000'000}}),
             Contains("sonopose_enclave_expiry_seconds{enclave=\"web\"} 1800000000\n"));
}

SCENARIO("the page is ready if every beacon has poses, and healthy while it observes") {
  Metrics metrics;
  const SteadyTime start{10'000'000'000};
  metrics.update({}, now_ns, start);
  CHECK(metrics.get("/readyz", start)->status == 503);
  CHECK(metrics.get("/healthz", start)->status == 200);
  metrics.update({view_of(7)}, now_ns, start);
  CHECK(metrics.get("/readyz", start)->status == 200);
  CHECK_FALSE(metrics.get("/index.html", start));
  observation::BeaconView lost = view_of(8);
  lost.lost = true;
  metrics.update({view_of(7), lost}, now_ns, start);
  CHECK(*metrics.get("/readyz", start)->body == "no poses of beacon 8\n");
  const SteadyTime later = start + 6'000'000'000;
  CHECK(metrics.get("/metrics", start)->status == 200);
  CHECK(metrics.get("/metrics", later)->status == 503);  // instead of values of the past
  CHECK(metrics.get("/healthz", later)->status == 503);
  CHECK(metrics.get("/readyz", later)->status == 503);
}

SCENARIO("promtool finds no mistake in the metrics") {
  if (std::system("command -v promtool >/dev/null") != 0) {
    std::cout << "skipped: no promtool; apt-get install prometheus installs it\n";
    return;
  }
  const test::TemporaryFolder folder;
  test::write_text(folder / "metrics", metrics_text({view_of(7), view_of(8)}, now_ns, {{"web", 1}}));
  CHECK(std::system(("promtool check metrics < " + (folder / "metrics").string()).c_str()) == 0);
  const std::string rules = SONOPOSE_SOURCE_DIR "/share/prometheus/sonopose.rules.yml";
  CHECK(std::system(("promtool check rules " + rules).c_str()) == 0);
}

}  // namespace metrics_test
