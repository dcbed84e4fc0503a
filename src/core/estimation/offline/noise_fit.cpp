#include "estimation/offline/forward.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sonopose::estimation::offline {
namespace {

constexpr std::size_t parameter_count = 4;
using Exponents = std::array<double, parameter_count>;  ///< exponents of factors 2^x on the defaults
/// Fixes hardly show how little process noise there is, and the defaults are those of a good IMU.
constexpr Exponents min_exponents{0.0, 0.0, 0.0, -1.0};
constexpr Exponents max_exponents{8.0, 8.0, 8.0, 1.0};

Noise noise_of(const Exponents& exponents) {
  Noise noise;
  noise.process.accel_mps2_rthz *= std::exp2(exponents[0]);
  noise.process.gyro_radps_rthz *= std::exp2(exponents[1]);
  noise.process.gyro_bias_radps_rts *= std::exp2(exponents[2]);
  noise.fix_scale = std::exp2(exponents[3]);
  return noise;
}

double log_likelihood(const settings::Settings& settings, const Segment& segment, const Noise& noise) {
  const Forward forward(settings, segment, noise);
  ForwardState state = Forward::start(segment);
  while (state.next_imu < segment.imu.size()) forward.step(state, nullptr);
  return std::isfinite(state.log_likelihood) ? state.log_likelihood : std::numeric_limits<double>::lowest();
}

/// First minutes of a segment.
Segment beginning(const Segment& segment) {
  constexpr double max_duration_s = 180.0;
  const TimeNs end_ns = segment.imu.front().time_ns + to_ns(max_duration_s);
  Segment part = segment;
  const auto is_after = [end_ns](const auto& measured) { return measured.time_ns > end_ns; };
  std::erase_if(part.imu, is_after);
  std::erase_if(part.states, is_after);
  std::erase_if(part.fixes, [&](const JudgedFix& fix) { return is_after(fix.measured); });
  std::erase_if(part.headings, [&](const JudgedHeading& heading) { return is_after(heading.measured); });
  return part;
}

}  // namespace

Noise fitted_noise(const settings::Settings& settings, std::span<const Segment> segments) {
  const auto longest = std::max_element(segments.begin(), segments.end(), [](const auto& a, const auto& b) {
    return a.fixes.size() < b.fixes.size();
  });
  if (longest == segments.end()) return {};
  const Segment part = beginning(*longest);
  if (!Forward::can_start(part)) return {};
  Exponents best{};
  double max_log_likelihood = log_likelihood(settings, part, noise_of(best));
  for (double step = 2.0; step >= 0.25; step *= 0.5) {
    for (bool improved = true; improved;) {
      improved = false;
      for (std::size_t i = 0; i < parameter_count; ++i) {
        for (const double change : {step, -step}) {
          Exponents next = best;
          next[i] = std::clamp(next[i] + change, min_exponents[i], max_exponents[i]);
          const double likelihood = log_likelihood(settings, part, noise_of(next));
          if (!(likelihood > max_log_likelihood + 0.1)) continue;
          max_log_likelihood = likelihood;
          best = next;
          improved = true;
          break;
        }
      }
    }
  }
  return noise_of(best);
}

}  // namespace sonopose::estimation::offline
