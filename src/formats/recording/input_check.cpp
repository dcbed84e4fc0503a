#include "recording/input_check.hpp"

#include "motion/imu_faults.hpp"
#include "motion/imu_summary.hpp"
#include "recording/truth_check.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sonopose::recording {

namespace {

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
std::vector<std::string> findings_of(const std::string& name, const std::vector<Sample>& samples,
                                     const std::vector<TruthSample>& truths,
                                     const csv::ColumnNames* names = nullptr) {
  InputCheck check(names);
  for (const Sample& sample : samples) check.add(sample);
  for (const TruthSample& truth : truths) check.add(truth);
  std::vector<std::string> texts = check.findings();
  for (std::string& text : texts) text.insert(0, name + ": ");
  return texts;
}

}  // namespace

void InputCheck::add(const ImuSample& imu) {
  imu_.push_back(imu.sensor_time_ns);
  if (const auto reading = motion::reading_of(imu)) window_.imu.push_back(*reading);
}

void InputCheck::add(const UltrasonicFix& fix) {
  if (!point_body_m_) point_body_m_ = fix.point_body_m;
  if (fix.point_body_m != *point_body_m_) return;  // of another tag
  fixes_.push_back(fix.emission_time_ns);
  if (fix.position_world_m.allFinite()) window_.fixes.push_back({fix.emission_time_ns, fix.position_world_m});
  fix_ages_ns_.push_back(fix.received_time_ns - fix.emission_time_ns);
  if (fix.quality_percent) qualities_percent_.push_back(*fix.quality_percent);
}

void InputCheck::add(const PairHeading& heading) {
  headings_.push_back(heading.emission_time_ns);
  if (heading.valid && std::isfinite(heading.heading_world_rad)) {
    window_.headings.push_back({heading.emission_time_ns, heading.heading_world_rad});
  }
  heading_ages_ns_.push_back(heading.received_time_ns - heading.emission_time_ns);
}

void InputCheck::add(const TwistSample& twist) {
  twists_.push_back(twist.emission_time_ns);
  twist_ages_ns_.push_back(twist.received_time_ns - twist.emission_time_ns);
  velocities_.add(twist);
}

void InputCheck::add(const TruthSample& truth) {
  truths_.push_back(truth);
}

void InputCheck::add(const Event& event) {
  std::visit([this](const auto& sample) { add(sample); }, event);
}

/// Sentence about where to name the unit of columns.
std::string InputCheck::how_to_name(std::string_view unit, Table table,
                                    std::initializer_list<std::string_view> columns) const {
  std::string text = names_ != nullptr ? fmt::format("For {}, add", unit)
                                       : "Messages of ROS have SI units; the header of a table names others:";
  for (const std::string_view column : columns) {
    if (names_ != nullptr) {
      text += " " + names_->option(static_cast<std::size_t>(table), std::string(column), unit);
    } else {
      text += fmt::format("{} {} [{}]", text.ends_with(':') ? "" : ",", column, unit);
    }
  }
  return text;
}

/// Suspects another unit of stamps at a rate that no sensor has.
std::optional<std::string> InputCheck::unit_of_time(const char* what, const Stamps& stamps, Table table,
                                                    double min_rate_hz, double max_rate_hz) const {
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
  const bool are_seconds =
      names_ != nullptr && names_->readers_in_seconds.contains(static_cast<std::size_t>(table));
  using Units = std::array<std::pair<const char*, double>, 3>;
  for (const auto& [unit, factor] : are_seconds ? Units{{{"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}}
                                                : Units{{{"us", 1e3}, {"ms", 1e6}, {"s", 1e9}}}) {
    const double would_be_hz = found_hz / factor;
    if (would_be_hz < min_rate_hz || would_be_hz > max_rate_hz) continue;
    return text + fmt::format("; are these in {}? Then they come at {:.3g} Hz. {}", unit, would_be_hz,
                              how_to_name(unit, table, {"timestamp"}));
  }
  return text + "; check their unit";
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

/// Suspects another clock if a stream begins and ends later or earlier than another one, by the same time.
std::optional<std::string> InputCheck::shift(const char* what, const Stamps& stamps, const Reference& other) {
  constexpr double leap_seconds_s = 18.0;
  if (other.stamps.empty() || stamps.empty()) return std::nullopt;
  const auto [first_other, last_other] = std::ranges::minmax(other.stamps);
  const auto [first, last] = std::ranges::minmax(stamps);
  const double begin_s = seconds_between(first_other, first);
  const double end_s = seconds_between(last_other, last);
  const double min_s = std::min(std::abs(begin_s), std::abs(end_s));
  if (begin_s * end_s <= 0.0 || min_s < other.min_s || std::abs(begin_s - end_s) > other.max_difference_s)
    return std::nullopt;
  return fmt::format("the {} begin {} and end {} {} the {}: are their stamps of one clock?{}", what,
                     seconds_text(std::abs(begin_s)), seconds_text(std::abs(end_s)),
                     begin_s > 0 ? "after" : "before", other.what,
                     std::abs(min_s - leap_seconds_s) < 1.0 ? " GPS time is 18 s ahead of UTC." : "");
}

/// Suspects times of reception that do not belong to those of emission.
std::optional<std::string> InputCheck::age(const char* what, const std::vector<TimeNs>& ages_ns) {
  constexpr double min_s = -0.05;
  constexpr double max_s = 10.0;
  if (ages_ns.empty()) return std::nullopt;
  const double age_s = seconds_between(0, quantile(ages_ns, 0.5));
  if (age_s >= min_s && age_s <= max_s) return std::nullopt;
  return fmt::format(
      "the {} are received {} {} their emission (median): are both times of one clock, and in "
      "the units that the header names?",
      what, seconds_text(std::abs(age_s)), age_s < 0 ? "before" : "after");
}

std::vector<std::string> InputCheck::units_of_readings(const motion::TurnGain& turn) const {
  if (window_.imu.empty()) return {};
  std::vector<std::string> texts = motion::imu_faults_of(window_);
  if (!texts.empty()) return texts;
  const motion::ImuSummary imu = motion::summary_of(window_.imu);
  const std::string force =
      fmt::format("the accelerometer reads {:.3g} m/s^2 (median)", imu.median_force_mps2);
  const auto asks_for = [this](const char* unit) {
    return how_to_name(unit, Table::imu, {"a_x", "a_y", "a_z"});
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
  const motion::TurnFault fault = motion::turn_fault_of(turn);
  if (fault == motion::TurnFault::wrong_sign || fault == motion::TurnFault::dead ||
      fault == motion::TurnFault::scale) {
    texts.push_back(fmt::format("the gyroscope measures {:.2f} of the turns that {} show: {}", turn.gain,
                                turn.by_heading ? "the headings" : "the fixes",
                                fault == motion::TurnFault::wrong_sign
                                    ? (turn.by_heading ? "are the headings clockwise, as of a compass, or is "
                                                         "its sign or the accelerometer's wrong?"
                                                       : "is its sign wrong, or that of the accelerometer?")
                                : fault == motion::TurnFault::dead
                                    ? "is its vertical axis dead?"
                                    : "is its scale wrong, or its range too small?"));
  }
  if (motion::has_rates_in_degrees(imu) || fault == motion::TurnFault::degrees) {
    const char* const unit = motion::has_rates_in_millidegrees(imu) ? "mdeg s^-1" : "deg s^-1";
    texts.push_back(
        fmt::format("the gyroscope exceeds {:.3g} rad/s in every twentieth sample, which is too fast or "
                    "contradicts gravity or headings; is it in {}? {}",
                    imu.fast_rate_radps, motion::has_rates_in_millidegrees(imu) ? "mdeg/s" : "deg/s",
                    how_to_name(unit, Table::imu, {"w_x", "w_y", "w_z"})));
  }
  return texts;
}

std::string InputCheck::question_about(const motion::FixFault& fault) const {
  switch (fault.kind) {
    case motion::FixFaultKind::unit:
      return fault.text + "; are they in mm, or in cm? " +
             how_to_name("mm", Table::positions, {"x", "y", "z"});
    case motion::FixFaultKind::default_position:
      return fault.text + ": leave them out, they were not measured";
    case motion::FixFaultKind::headings_in_radians:
      return fault.text + "; are they in rad? " + how_to_name("rad", Table::positions, {"heading"});
    case motion::FixFaultKind::headings_constant:
      return fault.text + ": leave them out, they were not measured";
    case motion::FixFaultKind::repeated:
    case motion::FixFaultKind::frozen:
      break;
  }
  return fault.text +
         ": are they sent again, or are the beacons frozen? A position counts once: leave its repetitions "
         "out";
}

/// Suspects a share instead of a percentage.
std::optional<std::string> InputCheck::unit_of_quality() const {
  constexpr std::size_t min_count = 10;
  if (qualities_percent_.size() < min_count) return std::nullopt;
  const auto is_fraction = [](double quality) { return quality > 0.0 && quality < 1.0; };
  const double best = *std::ranges::max_element(qualities_percent_);
  constexpr double max_percent = 100.0;
  if (best > max_percent)
    return fmt::format("the quality of fixes is up to {:.3g} %: is it another value?", best);
  if (best > 1.0 || std::ranges::none_of(qualities_percent_, is_fraction)) return std::nullopt;
  return fmt::format("the quality of all fixes is at most {:.3g} %; is it a share from 0 to 1? {}", best,
                     how_to_name("1", Table::positions, {"quality"}));
}

std::vector<std::string> InputCheck::findings() const {
  std::vector<std::string> texts;
  const auto add_if = [&texts](std::optional<std::string> text) {
    const bool is_found = text.has_value();
    if (text) texts.push_back(*std::move(text));
    return is_found;
  };
  if (imu_.empty()) texts.emplace_back("there is no IMU sample");
  TruthReferences references;
  references.gyroscope = !add_if(unit_of_time("IMU samples", imu_, Table::imu, 2.0, 10'000.0));
  references.fixes = !add_if(unit_of_time("fixes", fixes_, Table::positions, 0.05, 500.0));
  add_if(unit_of_time("headings", headings_, Table::positions, 0.05, 500.0));
  add_if(unit_of_time("velocities", twists_, Table::positions, 0.05, 5000.0));
  references.fixes &= !add_if(overlap("fixes", fixes_));
  add_if(overlap("headings", headings_));
  add_if(overlap("velocities", twists_));
  Stamps true_times;
  for (const TruthSample& truth : truths_) true_times.push_back(truth.time_ns);
  if (add_if(overlap("true poses", true_times))) references = {.fixes = false, .gyroscope = false};
  for (const auto& [what, stamps] :
       {std::pair("fixes", &fixes_), std::pair("headings", &headings_), std::pair("velocities", &twists_)}) {
    if (overlap(what, *stamps)) continue;
    // People who start and stop two programs differ by more.
    const bool is_shifted = add_if(
        shift(what, *stamps, {.what = "IMU samples", .stamps = imu_, .min_s = 1.5, .max_difference_s = 0.3}));
    if (stamps == &fixes_) references.fixes &= !is_shifted;
  }
  // The fixes of a pair have its headings.
  if (references.fixes && fixes_.size() == headings_.size()) {
    references.fixes &= !add_if(shift(
        "fixes", fixes_, {.what = "headings", .stamps = headings_, .min_s = 0.2, .max_difference_s = 0.02}));
  }
  add_if(age("fixes", fix_ages_ns_));
  add_if(age("headings", heading_ages_ns_));
  add_if(age("velocities", twist_ages_ns_));
  references.gyroscope &= !add_if(order_finding("IMU samples", imu_));
  add_if(order_finding("fixes", fixes_));
  add_if(order_finding("headings", headings_));
  add_if(order_finding("velocities", twists_));
  const motion::TurnGain turn = motion::turn_gain_of(window_);
  for (std::string& text : units_of_readings(turn)) {
    texts.push_back(std::move(text));
    references.gyroscope = false;
  }
  for (const motion::FixFault& fault : motion::fix_faults_of(window_, turn)) {
    const bool are_repeated =
        fault.kind == motion::FixFaultKind::repeated || fault.kind == motion::FixFaultKind::frozen;
    if (are_repeated && !references.gyroscope) continue;  // rates and force do not show motion
    texts.push_back(question_about(fault));
    references.fixes &= !are_repeated && fault.kind != motion::FixFaultKind::unit;
  }
  add_if(unit_of_quality());
  add_if(velocities_.unit(window_.fixes, [this](const char* unit) {
    return how_to_name(unit, Table::positions, {"v_x", "v_y", "v_z"});
  }));
  add_if(velocities_.sign_of_turns(window_.imu));
  for (std::string& text : truth_findings(truths_, window_, references)) texts.push_back(std::move(text));
  return texts;
}

std::optional<std::string> order_finding(const char* what, const std::vector<TimeNs>& stamps) {
  std::size_t steps_back = 0;
  std::size_t behind = 0;
  std::size_t first = 0;
  TimeNs latest_ns = stamps.empty() ? 0 : stamps.front();
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] < stamps[i - 1] && steps_back++ == 0) first = i;
    if (stamps[i] < latest_ns) ++behind;
    latest_ns = std::max(latest_ns, stamps[i]);
  }
  if (steps_back == 0) return std::nullopt;
  if (2 * steps_back > stamps.size()) {
    return fmt::format(
        "the {} are in reverse order of time: {} of {} are stamped earlier than the one before", what,
        steps_back, stamps.size());
  }
  return fmt::format("{} of {} {} are stamped earlier than one before them, in {}, the first by {}", behind,
                     stamps.size(), what, text::count_text(steps_back, "step back", "steps back"),
                     seconds_text(seconds_between(stamps[first], stamps[first - 1])));
}

std::vector<std::string> input_findings(const std::string& name, const std::vector<Event>& events,
                                        const csv::ColumnNames* names,
                                        const std::vector<TruthSample>& truths) {
  return findings_of(name, events, truths, names);
}

std::vector<std::string> input_findings(const std::string& name, const std::vector<ImuSample>& imu) {
  return findings_of(name, imu, {});
}

}  // namespace sonopose::recording
