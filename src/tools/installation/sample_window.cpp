#include "installation/sample_window.hpp"

#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <cmath>

namespace sonopose::installation {

SampleWindow::SampleWindow(const settings::Settings& settings)
    : delay_(settings.delay), calibration_(settings.calibration) {
  window_.mount_rad = settings.heading.mount_offset_deg * geometry::radians_per_degree;
}

void SampleWindow::add(const ImuSample& imu) {
  if (const auto reading = motion::reading_of(calibration_.corrected(imu))) window_.imu.push_back(*reading);
}

void SampleWindow::add(const UltrasonicFix& fix) {
  if ((fix.flags & ultrasonic_flag_set_pose) != 0U || !fix.position_world_m.allFinite()) return;
  if (!tag_body_m_) tag_body_m_ = fix.point_body_m;
  if (fix.point_body_m != *tag_body_m_) return;
  window_.fixes.push_back({estimation::aiding::measured_at(delay_, fix), fix.position_world_m});
}

void SampleWindow::add(const PairHeading& heading) {
  const bool is_set = (heading.flags & heading_flag_set_pose) != 0U;
  if (is_set || !heading.valid || !std::isfinite(heading.heading_world_rad)) return;
  const bool is_of_body = (heading.flags & heading_flag_of_body) != 0U;
  if (is_of_body && !are_headings_of_body_ && !window_.headings.empty()) return;
  if (!is_of_body && are_headings_of_body_) window_.headings.clear();
  are_headings_of_body_ = is_of_body;
  window_.heading_zero_rad = is_of_body ? window_.mount_rad : 0.0;
  window_.headings.push_back({estimation::aiding::measured_at(delay_, heading),
                              heading.heading_world_rad + window_.heading_zero_rad});
}

}  // namespace sonopose::installation
