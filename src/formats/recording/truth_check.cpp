#include "recording/truth_check.hpp"

#include <sonopose/calibration/model/axes.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/number_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace sonopose::recording {
namespace {

constexpr std::size_t min_count = 10;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Index of the first true pose at this time or later.
std::size_t first_at(const std::vector<TruthSample>& truth, TimeNs time_ns) {
  return static_cast<std::size_t>(std::ranges::lower_bound(truth, time_ns, {}, &TruthSample::time_ns) -
                                  truth.begin());
}

/// Doubt about the true positions.
struct PositionFinding {
  std::string text;
  bool is_constant = false;  ///< true if the steps between them are right
};

/// Suspects another frame if all true positions are on one side of the fixes, by several times their scatter.
std::optional<PositionFinding> of_offsets(const std::vector<Vector3d>& offsets_m) {
  constexpr double min_offset_m = 0.15;
  constexpr double min_ratio = 5.0;
  Vector3d usual_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3d& offset_m : offsets_m) values.push_back(offset_m(axis));
    usual_m(axis) = median(std::move(values));
  }
  std::vector<double> deviations_m;
  for (const Vector3d& offset_m : offsets_m) deviations_m.push_back((offset_m - usual_m).norm());
  if (usual_m.norm() < std::max(min_offset_m, min_ratio * median(std::move(deviations_m))))
    return std::nullopt;
  std::string text = "the true positions are usually";
  for (const double component_m : usual_m) text += ' ' + text::number_text(component_m, 2);
  text += " m from the fixes: are both of one frame, point and clock, or are the fixes biased?";
  return PositionFinding{.text = std::move(text), .is_constant = true};
}

/// Compares the fixes with the positions between which they were measured.
std::optional<PositionFinding> of_positions(const std::vector<TruthSample>& truth,
                                            const motion::Window& window) {
  constexpr double max_gap_s = 0.5;
  constexpr double max_median_m = 1.0;
  std::vector<double> distances_m;
  std::vector<double> factors;
  std::vector<Vector3d> offsets_m;
  for (const motion::Position& fix : window.fixes) {
    const std::size_t next = first_at(truth, fix.time_ns);
    if (next == 0 || next == truth.size()) continue;
    const TruthSample& before = truth[next - 1];
    const TruthSample& after = truth[next];
    const double gap_s = seconds_between(before.time_ns, after.time_ns);
    if (!(gap_s > 0.0 && gap_s <= max_gap_s)) continue;
    const double share = seconds_between(before.time_ns, fix.time_ns) / gap_s;
    const Vector3d at_m =
        before.position_world_m + share * (after.position_world_m - before.position_world_m);
    const Vector3d offset_m = at_m - fix.position_world_m;
    if (!offset_m.allFinite()) continue;
    offsets_m.push_back(offset_m);
    distances_m.push_back(offset_m.norm());
    if (fix.position_world_m.norm() > 0.0) factors.push_back(at_m.norm() / fix.position_world_m.norm());
  }
  if (distances_m.size() < min_count || factors.empty()) return std::nullopt;
  const double distance_m = median(distances_m);
  if (distance_m <= max_median_m) return of_offsets(offsets_m);
  const double factor = median(factors);
  std::string text = fmt::format(
      "the true positions are {:.3g} m from the fixes (median): are both in one frame", distance_m);
  for (const auto& [unit, of_unit] :
       {std::pair("mm", 1000.0), std::pair("cm", 100.0), std::pair("ft", 3.28084)}) {
    if (std::abs(factor / of_unit - 1.0) < 0.1) text += fmt::format(", or the true ones in {}", unit);
  }
  return PositionFinding{.text = text + "?"};
}

bool is_turn_known(const TruthSample& pose) {
  return pose.q_body_to_world.coeffs().allFinite();
}

/// Median difference between the turns of true poses and of a gyroscope whose stamps are moved by `shift_ns`,
/// as a share of the turn; above 1 for turns about other axes. Empty with few turns.
std::optional<double> turn_error(const std::vector<TruthSample>& truth, const motion::Window& window,
                                 TimeNs shift_ns) {
  constexpr double span_s = 0.5;
  constexpr double max_span_s = 1.0;
  constexpr double max_step_s = 0.1;
  constexpr double min_turn_rad = 15.0 * geometry::radians_per_degree;
  std::vector<double> errors;
  auto imu = window.imu.begin();
  for (std::size_t i = 0; i < truth.size();) {
    const TruthSample& from = truth[i];
    const std::size_t end = first_at(truth, from.time_ns + to_ns(span_s));
    if (end == truth.size()) break;
    i = std::max(end, i + 1);
    const TruthSample& to = truth[end];
    if (!is_turn_known(from) || !is_turn_known(to) || seconds_between(from.time_ns, to.time_ns) > max_span_s)
      continue;
    Quaterniond turn = Quaterniond::Identity();
    TimeNs at_ns = from.time_ns - shift_ns;
    const TimeNs end_ns = to.time_ns - shift_ns;
    bool is_whole = true;
    while (imu != window.imu.end() && imu->time_ns <= at_ns) ++imu;
    for (; imu != window.imu.end() && imu->time_ns <= end_ns; ++imu) {
      const double step_s = seconds_between(at_ns, imu->time_ns);
      is_whole = is_whole && step_s <= max_step_s;
      turn = (turn * geometry::rotation_by((step_s * imu->rate_body_radps).eval())).normalized();
      at_ns = imu->time_ns;
    }
    if (!is_whole || seconds_between(at_ns, end_ns) > max_step_s) continue;
    const Quaterniond true_turn =
        from.q_body_to_world.normalized().conjugate() * to.q_body_to_world.normalized();
    const double largest_rad = std::max(turn.angularDistance(Quaterniond::Identity()),
                                        true_turn.angularDistance(Quaterniond::Identity()));
    if (largest_rad >= min_turn_rad) errors.push_back(turn.angularDistance(true_turn) / largest_rad);
  }
  if (errors.size() < min_count) return std::nullopt;
  return median(std::move(errors));
}

/// The calibration.axes with which the gyroscope turns as the true poses do, and the force is up in them;
/// empty if there is none. Of several alike, the first is the least turned.
std::string mount_by_turns(const std::vector<TruthSample>& truth, const motion::Window& window,
                           double max_error) {
  constexpr double clearly_less = 0.7;
  constexpr double min_cosine = 0.7;  // between up by the true poses and the mean force
  Eigen::Vector3d up_body = Eigen::Vector3d::Zero();
  for (const TruthSample& pose : truth) {
    if (!is_turn_known(pose)) continue;
    up_body += pose.q_body_to_world.normalized().conjugate() * Eigen::Vector3d::UnitZ();
  }
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const motion::Reading& reading : window.imu) force += reading.force_body_mps2;
  const auto choices = calibration::choices_of(calibration::Axes{});
  std::string found;
  double min_error = max_error;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Eigen::Matrix3d sensor_to_body =
        calibration::sensor_to_body({.axes = static_cast<calibration::Axes>(i)});
    if (up_body.normalized().dot(sensor_to_body * force.normalized()) < min_cosine) continue;
    motion::Window turned;
    turned.imu = window.imu;
    for (motion::Reading& reading : turned.imu) {
      reading.rate_body_radps = sensor_to_body * reading.rate_body_radps;
    }
    const auto error = turn_error(truth, turned, 0);
    if (!error || *error >= (found.empty() ? min_error : clearly_less * min_error)) continue;
    min_error = *error;
    found = choices.at(i);
  }
  return found;
}

/// Compares the turns between true poses with those of the gyroscope, also of another mount or clock.
std::optional<std::string> of_orientations(const std::vector<TruthSample>& truth,
                                           const motion::Window& window) {
  constexpr double max_error = 0.6;
  constexpr double same_error = 0.5 * max_error;
  constexpr TimeNs step_ns = 100'000'000;
  constexpr int max_steps = 30;
  if (turn_error(truth, window, 0).value_or(0.0) <= max_error) return std::nullopt;
  if (const std::string axes = mount_by_turns(truth, window, same_error); !axes.empty()) {
    constexpr std::size_t at_up = 4;  // the last of three axes
    return "the true orientations turn as the gyroscope does with calibration.axes=" + axes +
           ", or another value that ends in " + axes.substr(at_up) + ": set it, if it is not";
  }
  double min_error = same_error;
  TimeNs shift_ns = 0;
  for (int step = -max_steps; step <= max_steps; ++step) {
    const auto error = turn_error(truth, window, step * step_ns);
    if (!error || *error >= min_error) continue;
    min_error = *error;
    shift_ns = step * step_ns;
  }
  if (shift_ns != 0) {
    return fmt::format(
        "the true orientations turn as the gyroscope does about {:.1f} s {}: are the stamps of "
        "one clock?",
        std::abs(seconds_between(0, shift_ns)), shift_ns < 0 ? "later" : "before");
  }
  return "the true orientations turn otherwise than the gyroscope: is the order of the quaternion as the "
         "header says, is it that of the IMU's axes, and does it turn the body to the world?";
}

/// Compares the velocities with the steps of the positions.
std::optional<std::string> of_velocities(const std::vector<TruthSample>& truth) {
  constexpr double span_s = 0.1;
  constexpr double max_span_s = 0.5;
  constexpr double min_speed_mps = 0.2;
  constexpr double max_error = 0.5;
  constexpr double same = 0.1;
  std::vector<double> errors;
  std::vector<double> factors;
  for (std::size_t i = 0; i < truth.size();) {
    const TruthSample& from = truth[i];
    const std::size_t end = first_at(truth, from.time_ns + to_ns(span_s));
    if (end == truth.size()) break;
    i = std::max(end, i + 1);
    const TruthSample& to = truth[end];
    const double step_s = seconds_between(from.time_ns, to.time_ns);
    const Vector3d moved_mps = (to.position_world_m - from.position_world_m) / step_s;
    const Vector3d stated_mps = 0.5 * (from.velocity_world_mps + to.velocity_world_mps);
    if (step_s > max_span_s || !stated_mps.allFinite() || !(moved_mps.norm() > min_speed_mps)) continue;
    errors.push_back((stated_mps - moved_mps).norm() / moved_mps.norm());
    factors.push_back(stated_mps.norm() / moved_mps.norm());
  }
  if (errors.size() < min_count || median(errors) <= max_error) return std::nullopt;
  const double factor = median(factors);
  const std::string text =
      fmt::format("the true velocities are {:.3g} times the motion of the true positions (median)", factor);
  for (const auto& [unit, of_unit] :
       {std::pair("km h^-1", 3.6), std::pair("cm s^-1", 100.0), std::pair("mm s^-1", 1000.0)}) {
    if (std::abs(factor / of_unit - 1.0) < same) return fmt::format("{}; are they in {}?", text, unit);
  }
  if (std::abs(factor - 1.0) < same) return text + ", in other directions: are they in axes of the body?";
  return text + "; check their unit";
}

}  // namespace

std::vector<std::string> truth_findings(const std::vector<TruthSample>& truth, const motion::Window& window,
                                        TruthReferences references) {
  std::vector<std::string> texts;
  const auto add_if = [&texts](std::optional<std::string> text) {
    if (text) texts.push_back(*std::move(text));
  };
  bool are_steps_right = true;  // otherwise velocities differ from them, too
  if (references.fixes) {
    if (auto finding = of_positions(truth, window)) {
      texts.push_back(std::move(finding->text));
      are_steps_right = finding->is_constant;
    }
  }
  if (references.gyroscope) add_if(of_orientations(truth, window));
  if (are_steps_right) add_if(of_velocities(truth));
  return texts;
}

}  // namespace sonopose::recording
