#include <sonopose/statistics/quantile.hpp>

#include <catch2/catch.hpp>

#include <limits>

namespace quantile_test {

using sonopose::statistics::quantile;

TEST_CASE("quantiles are values of the list, in whatever order it is") {
  const std::vector<double> values{40.0, 10.0, 50.0, 20.0, 30.0};
  CHECK(quantile(values, 0.0) == 10.0);
  CHECK(quantile(values, 0.5) == 30.0);
  CHECK(quantile(values, 0.74) == 30.0);
  CHECK(quantile(values, 0.75) == 40.0);
  CHECK(quantile(values, 1.0) == 50.0);
  CHECK(quantile({1.0, 2.0}, 0.5) == 1.0);
}

TEST_CASE("what is not finite does not count, and where nothing is left the quantile is 0") {
  const double infinity = std::numeric_limits<double>::infinity();
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(quantile({none, 3.0, infinity, 2.0, -infinity, 1.0}, 0.5) == 2.0);
  CHECK(quantile({infinity, 7.0, none}, 1.0) == 7.0);
  CHECK(quantile({none, infinity}, 0.5) == 0.0);
  CHECK(quantile({}, 0.5) == 0.0);
}

}  // namespace quantile_test
