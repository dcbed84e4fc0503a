#include "evaluation/replay/search.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace search_test {

using namespace sonopose;
using Catch::Matchers::Contains;

TEST_CASE("the search finds the minimum of a cost that depends on two settings") {
  const std::vector<evaluation::Variable> variables{
      evaluation::variable_of("documented.trust.sigma_m=0.05..0.5"),
      evaluation::variable_of("documented.trust.n_max=10..60")};
  const auto cost = [](const settings::Settings& settings) {
    return std::abs(std::log(settings.trust.sigma_m / 0.3)) + 0.01 * std::abs(settings.trust.n_max - 22);
  };
  const settings::Settings start;
  double last = cost(start);
  const auto found =
      evaluation::search(start, variables, cost, 2000, 1, [&](int, const evaluation::Found& better) {
        CHECK(better.cost < last);  // only improvements are reported
        last = better.cost;
      });
  CHECK(found.settings.trust.sigma_m == Approx(0.3).epsilon(0.02));
  CHECK(std::abs(found.settings.trust.n_max - 22) <= 1);
  CHECK(found.cost == last);
  CHECK(found.settings.drift.decay_rate_hz == start.drift.decay_rate_hz);  // not varied
}

TEST_CASE("the same seed gives the same search, and a search without improvement returns its start") {
  const std::vector<evaluation::Variable> variables{evaluation::variable_of("documented.trust.sigma_m")};
  const auto nothing = [](int, const evaluation::Found&) {};
  const auto cost = [](const settings::Settings& settings) {
    return std::sin(40.0 * settings.trust.sigma_m);
  };
  const auto once = evaluation::search({}, variables, cost, 50, 3, nothing);
  CHECK(evaluation::search({}, variables, cost, 50, 3, nothing).settings.trust.sigma_m ==
        once.settings.trust.sigma_m);
  const auto flat = evaluation::search(
      {}, variables, [](const auto&) { return 1.0; }, 50, 3, nothing);
  CHECK(flat.settings.trust.sigma_m == settings::Settings{}.trust.sigma_m);
}

TEST_CASE("a search that is ended returns the best so far") {
  const std::vector<evaluation::Variable> variables{
      evaluation::variable_of("documented.trust.sigma_m=0.1..0.5")};
  int evaluated = 0;
  const auto cost = [&evaluated](const settings::Settings& settings) {
    ++evaluated;
    return settings.trust.sigma_m;
  };
  settings::Settings start;
  start.trust.sigma_m = 0.5;
  double best = 0.5;
  const auto found = evaluation::search(
      start, variables, cost, 1000, 1, [&](int, const evaluation::Found& better) { best = better.cost; },
      [](int round) { return round < 10; });
  CHECK(evaluated == 11);  // the start, and ten rounds
  CHECK(found.cost == best);
  CHECK(best < 0.5);
}

TEST_CASE("a start outside the bounds is clamped before the search begins") {
  const std::vector<evaluation::Variable> variables{
      evaluation::variable_of("documented.trust.sigma_m=0.2..0.4"),
      evaluation::variable_of("documented.trust.n_max=2..5")};
  settings::Settings start;
  start.trust.sigma_m = 0.1;
  start.trust.n_max = 40;
  const auto cost = [](const settings::Settings& settings) {
    CHECK(settings.trust.sigma_m >= 0.2);
    CHECK(settings.trust.sigma_m <= 0.4);
    CHECK(settings.trust.n_max >= 2);
    CHECK(settings.trust.n_max <= 5);
    return settings.trust.sigma_m - settings.trust.n_max;  // minimum at the two bounds
  };
  const auto found = evaluation::search(start, variables, cost, 20, 1, [](int, const evaluation::Found&) {});
  CHECK(found.settings.trust.sigma_m == 0.2);
  CHECK(found.settings.trust.n_max == 5);
}

TEST_CASE("invalid search variables are refused with key, value and range") {
  CHECK_THROWS_WITH(evaluation::variable_of("documented.trust.enabled"),
                    Contains("documented.trust.enabled"));
  CHECK_THROWS_WITH(evaluation::variable_of("trust.sigmam"), Contains("documented.trust.sigma_m"));
  CHECK_THROWS_WITH(evaluation::variable_of("documented.trust.sigma_m=0.1"), Contains("LOW..HIGH"));
  CHECK_THROWS_WITH(evaluation::variable_of("documented.trust.sigma_m=0.1..99"),
                    Contains("0.1..99") && Contains("10"));
  CHECK_THROWS_WITH(evaluation::variable_of("documented.trust.sigma_m=0.2..0.1"),
                    Contains("0.2..0.1: LOW must be below HIGH"));
  CHECK(evaluation::variable_of("documented.trust.n_max").high == 1000);
}

}  // namespace search_test
