#include <sonopose/estimation/kalman/hypothesis_bank.hpp>

#include <catch2/catch.hpp>

#include <algorithm>

namespace kalman_hypothesis_bank_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

Hypothesis at(double x_m, Track track = Track::followed) {
  Hypothesis hypothesis;
  hypothesis.filter.position_world_m.x() = x_m;
  hypothesis.track = track;
  return hypothesis;
}

SCENARIO("the best hypothesis stays the best while others end") {
  GIVEN("three hypotheses, of which one is the best") {
    HypothesisBank bank;
    for (const double x_m : {0.0, 1.0, 2.0}) bank.spawn(at(x_m));
    const int best = GENERATE(0, 1, 2);
    const int ended = GENERATE(0, 1, 2);
    CAPTURE(best, ended);
    bank.best_index = best;
    WHEN("one ends") {
      bank.remove(&bank[ended]);
      THEN("two are left, and the best is the same one unless it has ended") {
        CHECK(bank.size() == 2);
        CHECK(std::none_of(bank.begin(), bank.end(), [&](const Hypothesis& each) {
          return each.filter.position_world_m.x() == ended;
        }));
        REQUIRE(bank.best_index < bank.size());
        if (ended != best) CHECK(bank.best().filter.position_world_m.x() == best);
      }
    }
  }
}

SCENARIO("following a track replaces what followed the one before") {
  GIVEN("a followed track with a distrustful model, another and a former one") {
    HypothesisBank bank;
    bank.spawn(at(0.0));
    bank.spawn(at(0.0)).imu = ImuModel::distrusts_imu;
    bank.spawn(at(5.0, Track::other));
    bank.spawn(at(9.0, Track::former));
    bank.best_index = 1;
    WHEN("the other track is followed") {
      bank.follow(bank.find(Track::other)->filter);
      THEN("each trusting model follows it, and a distrustful one no longer does") {
        for (int i = 0; i < closed_model_count; ++i) {
          const Hypothesis* const of_model = bank.find(static_cast<ImuModel>(i));
          REQUIRE(of_model != nullptr);
          CHECK(of_model->filter.position_world_m.x() == 5.0);
        }
        CHECK(bank.find(ImuModel::distrusts_imu) == nullptr);
        CHECK(bank.best().imu == ImuModel::rough);
      }
      THEN("the former one lives on") {
        CHECK(bank.find(Track::former)->filter.position_world_m.x() == 9.0);
      }
      THEN("only the model of another clock estimates an offset") {
        for (const Hypothesis& each : bank) {
          CHECK(each.filter.estimates_delay() == (each.imu == ImuModel::other_clock));
        }
      }
    }
  }
}

}  // namespace kalman_hypothesis_bank_test
