#include "sim/random.hpp"

#include <cmath>
#include <numbers>

namespace sonopose::sim {

namespace {

/// Spreads neighbouring seeds over all 64 bits (the finaliser of splitmix64).
std::uint64_t spread(std::uint64_t bits) {
  bits += 0x9E3779B97F4A7C15U;
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31U);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) : generator_(spread(spread(seed) ^ stream)) {}

double Random::uniform() {
  return static_cast<double>(generator_() >> 11U) * 0x1p-53;
}

double Random::uniform_in(const Range& range) {
  return range.min + (range.max - range.min) * uniform();
}

int Random::integer_in(int min, int max) {
  return min + static_cast<int>(static_cast<double>(max - min + 1) * uniform());
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 − [0, 1) is never 0
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Vector3d Random::normal_vector() {
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

Vector3d Random::direction() {
  return normal_vector().normalized();
}

Vector3d Random::horizontal_direction() {
  const double yaw_rad = uniform_in({-std::numbers::pi, std::numbers::pi});
  return {std::cos(yaw_rad), std::sin(yaw_rad), 0.0};
}

}  // namespace sonopose::sim
