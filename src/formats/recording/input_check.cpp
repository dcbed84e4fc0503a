#include "recording/input_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sonopose::recording {

namespace {

constexpr const char* how_to_name = "The header of a log folder's file names the unit: ";

template <class Value>
Value quantile(std::vector<Value> values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

double rate_hz(double step_ns) {
  return 1e9 / step_ns;
}

/// Seconds for a reader: without exponent and without useless digits.
std::string seconds_text(double seconds) {
  return fmt::format("{:.{}f} s", seconds, std::abs(seconds) < 1000.0 ? 3 : 0);
}

template <class Sample>
std::vector<std::string> findings_of(const std::string& name, const std::vector<Sample>& samples) {
  InputCheck check;
  for (const Sample& sample : samples) check.add(sample);
  std::vector<std::string> texts = check.findings();
  for (std::string& text : texts) text.insert(0, name + ": ");
  return texts;
}

}  // namespace

void InputCheck::Stamps::add(TimeNs time_ns) {
  if (count++ == 0) {
    min_ns = max_ns = last_ns = time_ns;
    return;
  }
  if (time_ns > last_ns) steps_ns.push_back(time_ns - last_ns);
  if (time_ns == last_ns) ++equal;
  if (time_ns < last_ns && earlier++ == 0) {
    first_earlier_ns = time_ns;
    before_it_ns = last_ns;
  }
  min_ns = std::min(min_ns, time_ns);
  max_ns = std::max(max_ns, time_ns);
  last_ns = time_ns;
}

void InputCheck::add(const ImuSample& imu) {
  imu_.add(imu.sensor_time_ns);
  const double force_mps2 = imu.specific_force_body_mps2.norm();
  const double rate_radps = imu.angular_velocity_body_radps.norm();
  if (std::isfinite(force_mps2)) forces_mps2_.push_back(force_mps2);
  if (std::isfinite(rate_radps)) rates_radps_.push_back(rate_radps);
}

void InputCheck::add(const UltrasonicFix& fix) {
  fixes_.add(fix.emission_time_ns);
}

void InputCheck::add(const Event& event) {
  if (const auto* imu = std::get_if<ImuSample>(&event)) add(*imu);
  if (const auto* fix = std::get_if<UltrasonicFix>(&event)) add(*fix);
}

/// Suspects another unit of stamps at a rate that no sensor has.
std::optional<std::string> InputCheck::unit_of_time(const char* what, const Stamps& stamps,
                                                    double min_rate_hz, double max_rate_hz) const {
  constexpr std::size_t min_steps = 10;
  if (2 * stamps.equal > stamps.count) {
    return fmt::format("{} of {} {} have the stamp of the one before", stamps.equal, stamps.count, what);
  }
  if (stamps.steps_ns.size() < min_steps) return std::nullopt;
  const double found_hz = rate_hz(static_cast<double>(quantile(stamps.steps_ns, 0.5)));
  if (found_hz >= min_rate_hz && found_hz <= max_rate_hz) return std::nullopt;
  const std::string text = fmt::format("the {} come at {:.6g} Hz by their stamps", what, found_hz);
  constexpr std::array<std::pair<const char*, double>, 3> units{{{"us", 1e3}, {"ms", 1e6}, {"s", 1e9}}};
  for (const auto& [unit, factor] : units) {
    const double would_be_hz = found_hz / factor;
    if (would_be_hz < min_rate_hz || would_be_hz > max_rate_hz) continue;
    return text + fmt::format("; are these in {0}? Then they come at {1:.3g} Hz. {2}timestamp [{0}]", unit,
                              would_be_hz, how_to_name);
  }
  return text + "; check the unit that the header names";
}

std::optional<std::string> InputCheck::order(const char* what, const Stamps& stamps) const {
  if (stamps.earlier == 0) return std::nullopt;
  if (2 * stamps.earlier > stamps.count) {
    return fmt::format(
        "the {} are in reverse order of time: {} of {} are stamped earlier than the one before", what,
        stamps.earlier, stamps.count);
  }
  return fmt::format("{} of {} {} are stamped earlier than the one before, the first by {}", stamps.earlier,
                     stamps.count, what,
                     seconds_text(seconds_between(stamps.first_earlier_ns, stamps.before_it_ns)));
}

std::optional<std::string> InputCheck::overlap() const {
  constexpr double min_apart_s = 1.0;
  if (imu_.count == 0 || fixes_.count == 0) return std::nullopt;
  const bool is_before = fixes_.max_ns < imu_.min_ns;
  if (!is_before && fixes_.min_ns <= imu_.max_ns) return std::nullopt;
  const double apart_s =
      is_before ? seconds_between(fixes_.max_ns, imu_.min_ns) : seconds_between(imu_.max_ns, fixes_.min_ns);
  if (apart_s < min_apart_s) return std::nullopt;
  return fmt::format(
      "all fixes are {} the IMU samples, by {} or more: are their stamps of one clock, and in "
      "the units that the headers name?",
      is_before ? "before" : "after", seconds_text(apart_s));
}

/// Suspects another unit, or none of gravity, if the usual force is not that of a body that stands or drives.
std::optional<std::string> InputCheck::unit_of_force() const {
  constexpr double min_mps2 = 7.0;
  constexpr double max_mps2 = 14.0;
  constexpr double max_g = 1.5;
  if (forces_mps2_.empty()) return std::nullopt;
  const double median_mps2 = quantile(forces_mps2_, 0.5);
  if (median_mps2 >= min_mps2 && median_mps2 <= max_mps2) return std::nullopt;
  std::string text = fmt::format("the accelerometer reads {:.3g} m/s^2 (median)", median_mps2);
  const double in_g = median_mps2 * standard_gravity_mps2;
  const double from_mg = median_mps2 * 1e-3 * standard_gravity_mps2;
  constexpr double max_spread = 0.3;  // without gravity the force varies by as much as it is
  const double spread_mps2 = quantile(forces_mps2_, 0.75) - quantile(forces_mps2_, 0.25);
  const bool is_steady = spread_mps2 < max_spread * median_mps2;
  if (is_steady && in_g >= min_mps2 && in_g <= max_g * standard_gravity_mps2) {
    return text + "; is it in g? " + how_to_name + "a_x [g], a_y [g], a_z [g]";
  }
  if (from_mg >= min_mps2 && from_mg <= max_g * standard_gravity_mps2) {
    return text + "; is it in mg or cm/s^2? " + how_to_name + "a_x [mg], a_y [mg], a_z [mg]";
  }
  if (median_mps2 < min_mps2) return text + "; was gravity removed? At rest it must read 9.8 upwards";
  return text + " instead of about 9.8";
}

std::optional<std::string> InputCheck::unit_of_rate() const {
  constexpr double usual_max_radps = 35.0;  // 2000 deg/s, the range of most gyroscopes
  constexpr double share = 0.95;
  if (rates_radps_.empty()) return std::nullopt;
  const double fast_radps = quantile(rates_radps_, share);
  if (fast_radps <= usual_max_radps) return std::nullopt;
  return fmt::format(
      "the gyroscope exceeds {:.3g} rad/s in every twentieth sample; is it in deg/s? {}w_x [deg s^-1], "
      "w_y [deg s^-1], w_z [deg s^-1]",
      fast_radps, how_to_name);
}

std::vector<std::string> InputCheck::findings() const {
  std::vector<std::string> texts;
  const auto add_if = [&texts](std::optional<std::string> text) {
    if (text) texts.push_back(*std::move(text));
  };
  if (imu_.count == 0) texts.emplace_back("there is no IMU sample");
  add_if(unit_of_time("IMU samples", imu_, 2.0, 10'000.0));
  add_if(unit_of_time("fixes", fixes_, 0.05, 500.0));
  add_if(overlap());
  add_if(order("IMU samples", imu_));
  add_if(order("fixes", fixes_));
  add_if(unit_of_force());
  add_if(unit_of_rate());
  return texts;
}

std::vector<std::string> input_findings(const std::string& name, const std::vector<Event>& events) {
  return findings_of(name, events);
}

std::vector<std::string> input_findings(const std::string& name, const std::vector<ImuSample>& imu) {
  return findings_of(name, imu);
}

}  // namespace sonopose::recording
