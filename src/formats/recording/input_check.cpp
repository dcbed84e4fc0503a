#include "recording/input_check.hpp"

#include "motion/imu_summary.hpp"

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

void InputCheck::add(const ImuSample& imu) {
  imu_.push_back(imu.sensor_time_ns);
  if (const auto reading = motion::reading_of(imu)) readings_.push_back(*reading);
}

void InputCheck::add(const UltrasonicFix& fix) {
  fixes_.push_back(fix.emission_time_ns);
  fix_ages_ns_.push_back(fix.received_time_ns - fix.emission_time_ns);
}

void InputCheck::add(const PairHeading& heading) {
  headings_.push_back(heading.emission_time_ns);
  heading_ages_ns_.push_back(heading.received_time_ns - heading.emission_time_ns);
}

void InputCheck::add(const Event& event) {
  std::visit([this](const auto& sample) { add(sample); }, event);
}

/// Suspects another unit of stamps at a rate that no sensor has.
std::optional<std::string> InputCheck::unit_of_time(const char* what, const Stamps& stamps,
                                                    double min_rate_hz, double max_rate_hz) {
  constexpr std::size_t min_steps = 10;
  std::size_t equal = 0;
  std::vector<TimeNs> steps_ns;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] == stamps[i - 1]) ++equal;
    if (stamps[i] > stamps[i - 1]) steps_ns.push_back(stamps[i] - stamps[i - 1]);
  }
  if (stamps.size() > min_steps && 2 * equal + 1 >= stamps.size()) {
    return fmt::format("{} of {} {} have the stamp of the one before", equal, stamps.size(), what);
  }
  if (steps_ns.size() < min_steps) return std::nullopt;
  const double found_hz = rate_hz(static_cast<double>(quantile(steps_ns, 0.5)));
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

std::optional<std::string> InputCheck::order(const char* what, const Stamps& stamps) {
  std::size_t earlier = 0;
  std::size_t first = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] < stamps[i - 1] && earlier++ == 0) first = i;
  }
  if (earlier == 0) return std::nullopt;
  if (2 * earlier > stamps.size()) {
    return fmt::format(
        "the {} are in reverse order of time: {} of {} are stamped earlier than the one before", what,
        earlier, stamps.size());
  }
  return fmt::format("{} of {} {} are stamped earlier than the one before, the first by {}", earlier,
                     stamps.size(), what, seconds_text(seconds_between(stamps[first], stamps[first - 1])));
}

/// Suspects another clock or unit if most stamps are before or after nearly all IMU samples.
std::optional<std::string> InputCheck::overlap(const char* what, const Stamps& stamps) const {
  constexpr double min_apart_s = 1.0;
  constexpr double stray_share = 0.01;  // a few wrong stamps must not hide it
  if (imu_.empty() || stamps.empty()) return std::nullopt;
  const TimeNs middle_ns = quantile(stamps, 0.5);
  const double before_s = seconds_between(middle_ns, quantile(imu_, stray_share));
  const double after_s = seconds_between(quantile(imu_, 1 - stray_share), middle_ns);
  if (std::max(before_s, after_s) < min_apart_s) return std::nullopt;
  return fmt::format(
      "most {} are {} the IMU samples, half of them by {} or more: are their stamps of one "
      "clock, and in the units that the headers name?",
      what, before_s > 0 ? "before" : "after", seconds_text(std::max(before_s, after_s)));
}

/// Suspects times of reception that do not belong to those of emission.
std::optional<std::string> InputCheck::age(const char* what, const std::vector<TimeNs>& ages_ns) {
  constexpr double min_s = -0.5;
  constexpr double max_s = 10.0;
  if (ages_ns.empty()) return std::nullopt;
  const double age_s = seconds_between(0, quantile(ages_ns, 0.5));
  if (age_s >= min_s && age_s <= max_s) return std::nullopt;
  return fmt::format(
      "the {} are received {} {} their emission (median): are both times of one clock, and in "
      "the units that the header names?",
      what, seconds_text(std::abs(age_s)), age_s < 0 ? "before" : "after");
}

std::vector<std::string> InputCheck::units_of_readings() const {
  if (readings_.empty()) return {};
  std::vector<std::string> texts;
  const motion::ImuSummary imu = motion::summary_of(readings_);
  const std::string force =
      fmt::format("the accelerometer reads {:.3g} m/s^2 (median)", imu.median_force_mps2);
  const auto asks_for = [](const char* unit) {
    return fmt::format("{0}a_x [{1}], a_y [{1}], a_z [{1}]", how_to_name, unit);
  };
  switch (motion::force_unit_of(imu)) {
    case motion::ForceUnit::mps2:
      break;
    case motion::ForceUnit::g:
      texts.push_back(force + "; is it in g? " + asks_for("g"));
      break;
    case motion::ForceUnit::mg:
      texts.push_back(force + "; is it in mg or cm/s^2? " + asks_for("mg"));
      break;
    case motion::ForceUnit::no_gravity:
      texts.push_back(force + "; was gravity removed? At rest it must read 9.8 upwards");
      break;
    case motion::ForceUnit::unknown:
      texts.push_back(force + " instead of about 9.8");
      break;
  }
  if (motion::has_rates_in_degrees(imu)) {
    texts.push_back(
        fmt::format("the gyroscope exceeds {:.3g} rad/s in every twentieth sample, which is too fast or "
                    "contradicts gravity; is it in deg/s? {}w_x [deg s^-1], w_y [deg s^-1], w_z [deg s^-1]",
                    imu.fast_rate_radps, how_to_name));
  }
  return texts;
}

std::vector<std::string> InputCheck::findings() const {
  std::vector<std::string> texts;
  const auto add_if = [&texts](std::optional<std::string> text) {
    if (text) texts.push_back(*std::move(text));
  };
  if (imu_.empty()) texts.emplace_back("there is no IMU sample");
  add_if(unit_of_time("IMU samples", imu_, 2.0, 10'000.0));
  add_if(unit_of_time("fixes", fixes_, 0.05, 500.0));
  add_if(unit_of_time("headings", headings_, 0.05, 500.0));
  add_if(overlap("fixes", fixes_));
  add_if(overlap("headings", headings_));
  add_if(age("fixes", fix_ages_ns_));
  add_if(age("headings", heading_ages_ns_));
  add_if(order("IMU samples", imu_));
  add_if(order("fixes", fixes_));
  add_if(order("headings", headings_));
  for (std::string& text : units_of_readings()) texts.push_back(std::move(text));
  return texts;
}

std::vector<std::string> input_findings(const std::string& name, const std::vector<Event>& events) {
  return findings_of(name, events);
}

std::vector<std::string> input_findings(const std::string& name, const std::vector<ImuSample>& imu) {
  return findings_of(name, imu);
}

}  // namespace sonopose::recording
