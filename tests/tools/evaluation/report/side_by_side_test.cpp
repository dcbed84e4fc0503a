#include "evaluation/report/side_by_side.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

namespace side_by_side_test {

using namespace sonopose::evaluation;

SCENARIO("the change over several cases is that of the geometric mean, with the spread of the cases") {
  GIVEN("one case that halves, one that stays, and one without truth") {
    const std::vector<CostPair> costs{
        {"a", true, 0.04, 0.02}, {"b", true, 0.10, 0.10}, {"c", false, 1.0, 3.0}};
    const Change change = change_of(costs, true);
    THEN("the mean falls by a factor of the square root of two") {
      CHECK(change.mean == Approx(std::sqrt(0.5) - 1.0));
    }
    THEN("two cases that differ do not prove it") {
      CHECK(2.0 * change.standard_error > std::abs(change.mean));
    }
    THEN("table and JSON have each case and what its cost is") {
      const std::string table = table_of(costs, "one.toml", "two.toml");
      CHECK_THAT(table, Catch::Contains("one.toml") && Catch::Contains("-50.0") &&
                            Catch::Contains("the prediction error"));
      const auto json = nlohmann::json::parse(json_of(costs, "one.toml", "two.toml"));
      CHECK(json["cases"][0]["change"].get<double>() == Approx(-0.5));
      CHECK(json["cases"][2]["has_truth"] == false);
      CHECK(json["with_truth"]["cases"] == 2);
      CHECK(json["without_truth"]["change"].get<double>() == Approx(2.0));
    }
  }
  GIVEN("cases that all improve by a tenth") {
    const std::vector<CostPair> costs{{"a", true, 0.1, 0.09}, {"b", true, 0.2, 0.18}, {"c", true, 1.0, 0.9}};
    THEN("the change is certain") {
      CHECK(change_of(costs, true).mean == Approx(-0.1));
      CHECK(change_of(costs, true).standard_error == Approx(0.0).margin(1e-9));
    }
  }
  GIVEN("a single case") {
    const std::vector<CostPair> costs{{"a", true, 0.1, 0.2}};
    THEN("the spread of the change is unknown") {
      CHECK(change_of(costs, true).mean == Approx(1.0));
      CHECK(std::isnan(change_of(costs, true).standard_error));
      CHECK_THAT(table_of(costs, "x", "y"), Catch::Contains("no spread"));
    }
  }
}

}  // namespace side_by_side_test
