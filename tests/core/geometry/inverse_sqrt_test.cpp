/// The fast inverse square root compared with the exact one.

#include <sonopose/geometry/inverse_sqrt.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <type_traits>

namespace inverse_sqrt_test {

using namespace sonopose;

/// Largest relative error over twelve decades, with 1000 values per factor of two.
template <class Scalar>
double largest_relative_error() {
  double largest = 0.0;
  for (double x = 1e-6; x < 1e6; x *= 1.000693) {
    const auto given = static_cast<Scalar>(x);
    const auto fast = static_cast<double>(geometry::fast_inverse_sqrt(given));
    largest = std::max(largest, std::abs(fast * std::sqrt(static_cast<double>(given)) - 1.0));
  }
  return largest;
}

/// Largest relative errors: of the first guess, after a Newton step that is enlarged by half of its largest
/// error, and after an ordinary one.
constexpr double guess_error = 0.0344;
constexpr double after_one_step = 0.5 * 1.5 * guess_error * guess_error;
constexpr double after_two_steps = 1.5 * after_one_step * after_one_step;

TEST_CASE("the fast inverse square root is as near as two Newton steps bring it") {
  const double of_float = largest_relative_error<float>();
  const double of_double = largest_relative_error<double>();
  INFO("largest relative error: float " << of_float << ", double " << of_double);
  // Plus rounding: a few times half a unit in the last place of a float.
  CHECK(of_float < after_two_steps + 4 * 6e-8);
  CHECK(of_double < after_two_steps);
  // The bound is tight.
  CHECK(of_float > 0.9 * after_two_steps);
  CHECK(of_double > 0.9 * after_two_steps);
}

TEST_CASE("the build's option selects which inverse square root is used") {
#ifdef SONOPOSE_FAST_INVERSE_SQRT
  CHECK(geometry::inverse_sqrt(2.0) == geometry::fast_inverse_sqrt(2.0));
  CHECK(geometry::inverse_sqrt(2.0F) == geometry::fast_inverse_sqrt(2.0F));
#else
  CHECK(geometry::inverse_sqrt(2.0) == 1.0 / std::sqrt(2.0));
  CHECK(geometry::inverse_sqrt(2.0F) == 1.0F / std::sqrt(2.0F));
#endif
  STATIC_REQUIRE(std::is_same_v<decltype(geometry::inverse_sqrt(2.0F)), float>);
}

}  // namespace inverse_sqrt_test
