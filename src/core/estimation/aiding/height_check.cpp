#include <sonopose/estimation/aiding/height_check.hpp>
#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/text/number_text.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::aiding {

void HeightCheck::on(const settings::PlanarSettings& settings, const UltrasonicFix& fix) {
  constexpr std::size_t memory = 40;
  if (settings.height_m != settings_.height_m || !ignores_height(settings)) count_ = 0;
  settings_ = settings;
  if (!ignores_height(settings) || (fix.flags & ultrasonic_flag_set_pose) != 0) return;
  const double above_m =
      (fix.position_world_m - position_in_plane(settings, fix.position_world_m, fix.point_body_m)).z();
  if (!std::isfinite(above_m)) return;
  if (count_ == 0) mean_m_ = variance_m2_ = 0;
  ++count_;
  const double share = 1.0 / static_cast<double>(std::min(count_, memory));
  const double deviation_m = above_m - mean_m_;
  mean_m_ += share * deviation_m;
  variance_m2_ = (1.0 - share) * (variance_m2_ + share * deviation_m * deviation_m);
}

std::optional<HeightProblem> HeightCheck::problem(bool is_known) const {
  constexpr std::size_t min_count = 20;
  const double hysteresis = is_known ? 0.7 : 1.0;
  const double min_mean_m = hysteresis * 0.3;  // above what beacons at one height leave open
  const double min_ratio = hysteresis * 2.0;
  const double size_m = std::abs(mean_m_);
  if (count_ < min_count || size_m < min_mean_m || size_m < min_ratio * std::sqrt(variance_m2_))
    return std::nullopt;
  return HeightProblem{"the fixes are " + text::number_text(size_m, 2) + " m " +
                           (mean_m_ > 0 ? "above" : "below") + " motion.height_m",
                       "set motion.height_m=" + text::number_text(settings_.height_m + mean_m_, 2) +
                           ", or motion.height_from=fixes"};
}

}  // namespace sonopose::estimation::aiding
