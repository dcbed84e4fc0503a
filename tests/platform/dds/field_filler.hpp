#pragma once
// Fills every field of a sample with a unique value.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <string>
#include <type_traits>

namespace sonopose::dds::test {

class Filler {
public:
  /// Fills the fields in order.
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

  void fill(bool& field) { field = true; }
  void fill(double& field) { field = number(); }
  void fill(Vector3d& field) { field = vector(); }
  void fill(Quaterniond& field) {
    const Vector3d v = vector();
    field = Quaterniond(number(), v.x(), v.y(), v.z());  // four values, not a rotation
  }
  void fill(std::string& field) { field = std::to_string(next()); }
  void fill(ScalarEstimate& field) { all(field.value, field.std); }
  void fill(VectorEstimate& field) { all(field.value, field.std); }
  template <int N>
  void fill(Covariance<N>& field) {
    for (int row = 0; row < N; ++row) {
      for (int column = row; column < N; ++column) field.set(row, column, number());
    }
  }
  template <class Integer>
  std::enable_if_t<std::is_integral_v<Integer>> fill(Integer& field) {
    field = static_cast<Integer>(next());
  }
  template <class Value>
  void fill(std::optional<Value>& field) {
    fill(field.emplace());
  }

  double last_ = 100;
};

}  // namespace sonopose::dds::test
