#include <sonopose/calibration/model/affine.hpp>

#include <Eigen/LU>

#include <algorithm>

namespace sonopose::calibration {
namespace {

Eigen::Map<const Matrix3d> matrix_view(const std::array<double, 9>& columns) {
  return Eigen::Map<const Matrix3d>(columns.data());
}

Eigen::Map<const Vector3d> vector_view(const std::array<double, 3>& elements) {
  return Eigen::Map<const Vector3d>(elements.data());
}

}  // namespace

Affine::Affine() : Affine(Matrix3d::Identity(), Vector3d::Zero(), Vector3d::Zero()) {}

Affine::Affine(const Matrix3d& matrix, const Vector3d& before, const Vector3d& after)
    : does_nothing_(matrix == Matrix3d::Identity() && before.isZero(0.0) && after.isZero(0.0)) {
  std::copy_n(matrix.data(), 9, matrix_.begin());
  std::copy_n(before.data(), 3, before_.begin());
  std::copy_n(after.data(), 3, after_.begin());
}

Vector3d Affine::operator()(const Vector3d& vector) const noexcept {
  if (does_nothing_) return vector;
  return matrix_view(matrix_) * (vector - vector_view(before_)) - vector_view(after_);
}

Vector3d Affine::inverse_of(const Vector3d& vector) const noexcept {
  return matrix_view(matrix_).inverse() * (vector + vector_view(after_)) + vector_view(before_);
}

Affine Affine::turned_by(const Matrix3d& rotation) const {
  return {rotation * matrix_view(matrix_), vector_view(before_), rotation * vector_view(after_)};
}

}  // namespace sonopose::calibration
