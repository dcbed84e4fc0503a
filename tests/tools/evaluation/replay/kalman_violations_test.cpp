/// Accuracy of the Kalman engine with sensors that violate its model. No parameter was chosen on the seeds
/// 6001 to 6040.

#include "evaluation/replay/evaluation.hpp"
#include "support/seeds.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace kalman_violations_test {

using namespace sonopose;

/// A requirement of the project (docs/accuracy.md, "Violations").
struct Bar {
  std::string scenario;
  double position_m;
  double yaw_deg = 1.0;
};

const std::vector<Bar> bars{{"accel_bias_steps", 0.04},
                            {"warming_imu", 0.04},
                            {"door_sills", 0.03},
                            {"clipped_kerbs", 0.055},
                            {"swaying", 0.016},
                            {"flat_beacons", 0.12},
                            {"default_positions", 0.025},
                            {"dead_gyro_axis", 0.08, 15.0},
                            {"inverted_gyro_axis", 0.10, 40.0},
                            {"wrong_accelerometer", 0.10, 1.0},
                            {"imu_scale", 0.03, 3.0},
                            {"noisy_imu", 0.06, 3.0},
                            {"coarse_fixes", 0.05},
                            {"gyro_saturation", 0.08, 40.0},
                            {"wrong_headings", 0.03, 4.0},
                            {"bad_reception", 0.20}};

TEST_CASE("a violated model costs the Kalman engine little", "[accuracy]") {
  for (const Bar& bar : bars) {
    std::vector<evaluation::Case> runs;
    for (unsigned i = 0; i < test::seeds(5, 40); ++i) {
      runs.push_back(evaluation::simulated_case(sim::find_scenario(bar.scenario), 6001 + i));
    }
    const auto summary = evaluation::summarise(evaluation::evaluate_all(runs, {}));
    INFO(bar.scenario << ": " << summary.position_rmse_m << " m, " << summary.yaw_rmse_deg
                      << " degrees, lost for " << summary.lost_s << " s");
    CHECK(summary.position_rmse_m < bar.position_m);
    CHECK(summary.yaw_rmse_deg < bar.yaw_deg);
    CHECK(summary.position_rmse_m < 1.1 * summary.extrapolated_rmse_m);
    CHECK(summary.lost_s < 3.0);
  }
}

}  // namespace kalman_violations_test
