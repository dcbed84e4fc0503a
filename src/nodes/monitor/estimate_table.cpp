#include "monitor/estimate_table.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>

#include <optional>
#include <string_view>

namespace sonopose::monitor {
namespace {

/// A value and its standard deviation, if known: "0.0120±0.0010".
std::string with_std(double value, double std, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return std < 0.0 ? text : fmt::format("{}±{:.{}f}", text, std, decimals);
}

/// The lines of one beacon.
class Lines {
public:
  explicit Lines(BeaconAddress address) : prefix_(fmt::format("{:>6}  ", address)) {}

  void add(std::string_view name, const std::optional<VectorEstimate>& estimate, std::string_view unit) {
    if (!estimate) return add_missing(name);
    std::string values;
    for (int axis = 0; axis < 3; ++axis) {
      values += fmt::format("{:>16}", with_std(estimate->value[axis], estimate->std[axis], 4));
    }
    text_ += fmt::format("{}{:<18}{} {}\n", prefix_, name, values, unit);
  }

  void add(std::string_view name, const std::optional<ScalarEstimate>& estimate, std::string_view unit,
           double units_per_si = 1.0) {
    if (!estimate) return add_missing(name);
    const double std = estimate->std < 0.0 ? estimate->std : estimate->std * units_per_si;
    text_ += fmt::format("{}{:<18}{:>16} {}\n", prefix_, name,
                         with_std(estimate->value * units_per_si, std, 4), unit);
  }

  [[nodiscard]] std::string text() const {
    return missing_.empty() ? text_ : text_ + prefix_ + missing_ + "\n";
  }

private:
  static constexpr std::size_t max_columns = 80;

  void add_missing(std::string_view name) {
    const bool first = missing_.empty();
    missing_ += first ? "not estimated: " : ", ";
    column_ += first ? prefix_.size() + missing_.size() : 2;
    if (column_ + name.size() + 1 > max_columns) {  // a comma may follow
      missing_.back() = '\n';
      missing_ += std::string(prefix_.size() + 2, ' ');
      column_ = prefix_.size() + 2;
    }
    missing_ += name;
    column_ += name.size();
  }

  std::string prefix_;
  std::string text_;
  std::string missing_;
  std::size_t column_ = 0;  ///< column at the end of missing_
};

}  // namespace

std::string estimate_table_of(const std::vector<observation::BeaconView>& views) {
  std::string text;
  for (const observation::BeaconView& view : views) {
    if (!view.estimate) continue;
    const Estimate& estimate = *view.estimate;
    Lines lines(view.address);
    lines.add("gyro bias", estimate.gyro_bias_body_radps, "rad/s");
    lines.add("accelerometer bias", estimate.accelerometer_bias_body_mps2, "m/s²");
    lines.add("lever arm", estimate.lever_arm_body_m, "m");
    lines.add("delay", estimate.delay_s, "s");
    lines.add("fix noise", estimate.fix_noise_m, "m");
    lines.add("heading noise", estimate.heading_noise_rad, "deg", 1.0 / geometry::radians_per_degree);
    text += lines.text();
  }
  if (text.empty()) return text;
  return fmt::format("{:<26}{:>16}{:>16}{:>16}\n", "beacon  estimated", "x", "y", "z") + text;
}

}  // namespace sonopose::monitor
