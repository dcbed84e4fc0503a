/// Detection of rest.

#include <sonopose/attitude/rest.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace rest_test {

using namespace sonopose;
using namespace sonopose::attitude;

struct Rig {
  RestSettings settings;
  RestState<double> state;

  /// Feeds 100 Hz samples for `duration_s`, each changed by `alter(measurement, t)`.
  template <class Alter>
  void feed(double duration_s, const Alter& alter) {
    for (int i = 0; i < std::lround(duration_s * 100.0); ++i) {
      Measurement<double> measurement;
      measurement.specific_force_body_mps2 = {0.5, -1.0, 9.7};
      alter(measurement, 0.01 * i);
      rest::update(settings, state, measurement, 0.01, 0.035);
    }
  }

  [[nodiscard]] bool resting() const { return rest::is_resting(settings, state); }
};

const auto quiet = [](Measurement<double>&, double) {};

TEST_CASE("rest is detected after the set time, with the mean rate") {
  Rig rig;
  rig.feed(1.0, [](Measurement<double>& m, double) { m.angular_velocity_body_radps.x() = 0.01; });
  CHECK_FALSE(rig.resting());
  rig.feed(1.0, [](Measurement<double>& m, double) { m.angular_velocity_body_radps.x() = 0.01; });
  CHECK(rig.resting());
  CHECK(rig.state.rate_mean_body_radps.x() == Approx(0.01));
}

TEST_CASE("one knock, one turn or one steady turn ends rest and restarts its timer") {
  using Disturb = void (*)(Measurement<double>&, double);
  const Disturb knock = [](Measurement<double>& m, double) { m.specific_force_body_mps2.x() += 2.0; };
  const Disturb twitch = [](Measurement<double>& m, double) { m.angular_velocity_body_radps.z() = 0.2; };
  for (const Disturb disturb : {knock, twitch}) {
    Rig rig;
    rig.feed(3.0, quiet);
    REQUIRE(rig.resting());
    rig.feed(0.01, disturb);
    CHECK_FALSE(rig.resting());
    rig.feed(rig.settings.still_s - 0.2, quiet);
    CHECK_FALSE(rig.resting());
    rig.feed(2.0, quiet);
    CHECK(rig.resting());
  }
}

TEST_CASE("a steady rate beyond any offset is a turn, however steady it is") {
  Rig rig;
  rig.feed(30.0, [](Measurement<double>& m, double) { m.angular_velocity_body_radps.z() = 0.05; });
  CHECK_FALSE(rig.resting());
}

}  // namespace rest_test
