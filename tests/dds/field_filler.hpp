#pragma once
// Gives every field of a sample a value that no other one has.

#include <sonopose/samples/samples.hpp>

#include <type_traits>

namespace sonopose::dds::test {

class Filler {
public:
  /// Fills fields in their order.
  template <class... Fields>
  void all(Fields&... fields) {
    (fill(fields), ...);
  }

  double number() { return next() + 0.25; }
  Vector3d vector() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }

private:
  double next() { return ++last_; }

  void fill(double& field) { field = number(); }
  void fill(Vector3d& field) { field = vector(); }
  void fill(Quaterniond& field) {
    const Vector3d v = vector();
    field = Quaterniond(number(), v.x(), v.y(), v.z());  // no rotation, but four values
  }
  template <class Integer>
  std::enable_if_t<std::is_integral_v<Integer>> fill(Integer& field) {
    field = static_cast<Integer>(next());
  }
  void fill(std::optional<double>& field) { field = number(); }

  double last_ = 100;
};

}  // namespace sonopose::dds::test
