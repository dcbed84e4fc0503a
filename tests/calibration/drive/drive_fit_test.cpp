#include "calibration/drive/drive_fit.hpp"

#include "calibration/drive/simulated_drive.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <iomanip>
#include <iostream>
#include <string>

namespace drive_fit_test {

using namespace sonopose;
using namespace sonopose::test;
using namespace sonopose::calibration::drive;
using Catch::Contains;

constexpr double degree = geometry::radians_per_degree;
constexpr std::array measured{Quantity::mount,        Quantity::delay,       Quantity::lever_arm_x,
                              Quantity::lever_arm_y,  Quantity::lever_arm_z, Quantity::fix_horizontal,
                              Quantity::fix_vertical, Quantity::heading};

DriveFit calibrated(const SimulatedDrive& drive) {
  return calibrate_drive(drive.recordings, settings::Settings{});
}

TEST_CASE("a drive of two minutes shows mount, delay, lever arm and noise together") {
  // These seeds were never looked at while parameters were chosen.
  struct Case {
    const char* scenario;
    std::uint64_t seed;
    double mount_deg;
    double delay_s;
  };
  for (const Case& wanted :
       {Case{"walk", 901, 1.0, 0.008}, Case{"walk", 902, 1.0, 0.008}, Case{"forklift", 903, 0.3, 0.0025},
        Case{"kart", 904, 0.3, 0.0025}, Case{"kart", 905, 0.3, 0.0025}}) {
    GIVEN(std::string("an unknown installation, ") + wanted.scenario + ", seed " +
          std::to_string(wanted.seed)) {
      const SimulatedDrive drive = random_drive(wanted.scenario, wanted.seed);
      WHEN("it is calibrated from the drive alone") {
        const DriveFit fit = calibrated(drive);
        THEN("mount, delay and noise are right") {
          CHECK(fit.converged);
          CHECK(fit.mount_method == MountMethod::likelihood);
          for (const Quantity known : {Quantity::mount, Quantity::delay, Quantity::fix_horizontal,
                                       Quantity::fix_vertical, Quantity::heading}) {
            CAPTURE(known, fit[known].missing);
            CHECK(fit[known].is_known());
          }
          CHECK(std::abs(error_of(drive, fit, Quantity::mount)) < wanted.mount_deg * degree);
          CHECK(std::abs(error_of(drive, fit, Quantity::delay)) < wanted.delay_s);
          for (const Quantity noise : {Quantity::fix_horizontal, Quantity::fix_vertical, Quantity::heading}) {
            CAPTURE(noise);
            CHECK(fit[noise].value == Approx(drive.true_value(noise)).epsilon(0.1));
          }
          AND_THEN("so is the lever arm where it is known, and its z on level ground is not") {
            if (std::string(wanted.scenario) == "walk") CHECK(fit[Quantity::lever_arm_x].is_known());
            for (const Quantity arm : {Quantity::lever_arm_x, Quantity::lever_arm_y}) {
              if (!fit[arm].is_known()) continue;
              CHECK(std::abs(error_of(drive, fit, arm)) < 0.005);
            }
            CHECK_THAT(fit[Quantity::lever_arm_z].missing, Contains("tilt"));
          }
        }
      }
    }
  }
}

/// Errors and intervals over many seeds, for docs/calibration.md; not part of the tests.
TEST_CASE("accuracy of a calibration from a drive", "[.accuracy]") {
  constexpr std::uint64_t first_seed = 2001;
  constexpr int runs = 20;
  std::cout << std::fixed << "scenario | quantity | known | within the limit | covered | RMS error\n";
  for (const char* scenario :
       {"walk", "forklift", "kart", "circle", "spin", "drone", "hand_held", "outlier_bursts"}) {
    std::array<int, quantity_count> known{};
    std::array<int, quantity_count> within{};
    std::array<int, quantity_count> covered{};
    std::array<double, quantity_count> squares{};
    const bool is_slow = std::string_view(scenario) == "walk";
    for (int run = 0; run < runs; ++run) {
      const SimulatedDrive drive = random_drive(scenario, first_seed + static_cast<std::uint64_t>(run));
      const DriveFit fit = calibrated(drive);
      for (const Quantity quantity : measured) {
        const auto at = static_cast<std::size_t>(quantity);
        if (!fit[quantity].is_known()) continue;
        const bool is_relative = quantity >= Quantity::fix_horizontal;
        const double error = error_of(drive, fit, quantity) / (is_relative ? drive.truth[at] : 1.0);
        const double limit = is_relative                   ? 0.1
                             : quantity == Quantity::mount ? (is_slow ? 1.0 : 0.3) * degree
                             : quantity == Quantity::delay ? (is_slow ? 0.008 : 0.0025)
                                                           : 0.005;
        ++known.at(at);
        within.at(at) += std::abs(error) < limit ? 1 : 0;
        covered.at(at) += is_covered(drive, fit, quantity) ? 1 : 0;
        squares.at(at) += error * error;
      }
    }
    for (const Quantity quantity : measured) {
      const auto at = static_cast<std::size_t>(quantity);
      const double scale = quantity == Quantity::mount            ? 1.0 / degree
                           : quantity >= Quantity::fix_horizontal ? 100.0
                                                                  : 1000.0;
      std::cout << scenario << " | " << choices_of(quantity).at(at) << " | " << known.at(at) << " | "
                << within.at(at) << " | " << covered.at(at) << " | " << std::setprecision(2)
                << (known.at(at) == 0 ? 0.0 : scale * std::sqrt(squares.at(at) / known.at(at))) << '\n';
    }
    std::cout << std::flush;
  }
}

}  // namespace drive_fit_test
