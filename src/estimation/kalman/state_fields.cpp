#include <sonopose/estimation/documented/admission.hpp>
#include <sonopose/estimation/kalman/state_fields.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace sonopose::estimation::kalman {
namespace {

/// Looks for counts and times with which arithmetic could overflow, in all records.
struct RangeCheck {
  std::optional<FieldFault>& fault;

  void operator()(const char* name, int count) const {
    constexpr int most = 1'000'000'000;
    if (count < 0 || count > most) report(name, "is not between 0 and 1e9");
  }
  void operator()(const char* name, TimeNs time_ns) const {
    if (time_ns != 0 && !documented::admission::is_time(time_ns)) report(name, "is not a valid time");
  }
  template <class Record>
  void operator()(const char* /*name*/, const std::vector<Record>& records) const {
    for (const Record& record : records) for_each_field(record, *this);
  }
  template <class Record, std::size_t count>
  void operator()(const char* /*name*/, const std::array<Record, count>& records) const {
    for (const Record& record : records) for_each_field(record, *this);
  }
  template <class Field>
  void operator()(const char* /*name*/, const Field& field) const {
    if constexpr (requires { for_each_field(field, *this); }) for_each_field(field, *this);
  }

private:
  void report(const char* name, const char* what) const {
    if (!fault) fault = FieldFault{name, what};
  }
};

bool is_covariance(const Filter& filter) {
  using Joint = Eigen::Matrix<double, state_size + 1, state_size + 1>;  // with the delay
  Joint joint;
  joint << filter.covariance, filter.delay_covariance, filter.delay_covariance.transpose(),
      filter.delay_variance_s2;
  if (joint != joint.transpose() || !(joint.diagonal().minCoeff() >= 0.0)) return false;
  // The correlations, with a margin for what rounding leaves.
  constexpr double margin = 1e-9;
  const Joint scale = joint.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse().asDiagonal();
  Joint correlation = scale * joint * scale;
  correlation.diagonal().array() += margin;
  return Eigen::LLT<Joint>(correlation).info() == Eigen::Success;
}

bool is_trend(const Trend& trend) {
  return trend.weight >= 0.0 && trend.time_squares_s2 >= 0.0;
}

/// What the engine has learned of intervals and durations.
std::optional<FieldFault> find_timing_fault(const Belief& base) {
  const auto is_between = [](double value, double most) { return value >= 0.0 && value <= most; };
  constexpr double longest_gap_s = 5.0;  // that outage.imu_gap_s may be
  if (!is_between(base.usual_step_s, longest_gap_s)) {
    return FieldFault{"usual_step_s", "is not between 0 and 5 s"};
  }
  if (!is_between(base.heading_interval_s, longest_heading_interval_s)) {
    return FieldFault{"heading_interval_s", "is not between 0 and 10 s"};
  }
  if (!(base.wrong_tracks.longest_s >= 0.0)) {
    return FieldFault{"wrong_tracks.longest_s", "is negative or no number"};
  }
  if (base.default_position.fixes >= 2 * static_cast<int>(DefaultPosition::capacity)) {
    return FieldFault{"default_position.fixes", "is more than twice the number of places"};
  }
  if (!is_trend(base.rest.fixes)) return FieldFault{"rest.fixes", "have a negative weight or square"};
  if (!is_trend(base.rest.headings)) return FieldFault{"rest.headings", "have a negative weight or square"};
  return std::nullopt;
}

std::optional<FieldFault> find_fault(const Belief& base) {
  if (base.candidate_count > most_candidates) {
    return FieldFault{"candidate_count", "is more than the number of starts"};
  }
  if (base.phase != Phase::waiting && base.candidate_count == 0) {
    return FieldFault{"candidate_count", "is 0 although the estimate has begun"};
  }
  if (base.phase == Phase::tracking && base.candidate_count != model_count &&
      base.candidate_count != closed_count) {
    return FieldFault{"candidate_count", "is not the number of models"};
  }
  if (base.best >= std::max(base.candidate_count, 1)) {
    return FieldFault{"best", "is not the index of a candidate"};
  }
  if (!(base.trust >= 0.0 && base.trust <= 1.0)) return FieldFault{"trust", "is not between 0 and 1"};
  const auto candidates_end = base.candidates.begin() + base.candidate_count;
  if (!std::all_of(base.candidates.begin(), candidates_end,
                   [](const Candidate& candidate) { return is_covariance(candidate.filter); })) {
    return FieldFault{"candidates", "have a matrix that is not a covariance"};
  }
  if (base.rival.alive && !is_covariance(base.rival.filter)) {
    return FieldFault{"rival", "has a matrix that is not a covariance"};
  }
  if (base.former.model >= model_count) return FieldFault{"model", "is not the index of a model"};
  if (base.former.alive && !is_covariance(base.former.filter)) {
    return FieldFault{"former", "has a matrix that is not a covariance"};
  }
  const auto is_variance = [](const AdaptiveVariance& any) {
    return any.variance >= 0.0 && any.samples >= 0.0 && any.motion_variance >= 0.0;
  };
  const auto is_positive = [&](const AdaptiveVariance& any) {
    return is_variance(any) && any.variance > 0.0 && any.motion_variance > 0.0;
  };
  const MeasurementNoise& noise = base.noise;
  if (!std::all_of(noise.bins.begin(), noise.bins.end(), [&](const MeasurementNoise::Bin& bin) {
        return is_variance(bin.horizontal_m2) && is_variance(bin.vertical_m2);
      })) {
    return FieldFault{"noise.bins", "have a negative variance"};
  }
  if (!is_positive(noise.any_quality.horizontal_m2) || !is_positive(noise.any_quality.vertical_m2)) {
    return FieldFault{"noise.any_quality", "has a variance that is not positive"};
  }
  if (!is_positive(noise.heading_rad2)) return FieldFault{"noise.heading_rad2", "is not positive"};
  return find_timing_fault(base);
}

}  // namespace

std::optional<FieldFault> find_fault(const Snapshot& snapshot) {
  std::optional<FieldFault> fault;
  for_each_field(snapshot, RangeCheck{fault});
  if (!fault) fault = find_fault(snapshot.history.base);
  if (fault) return fault;
  const History& history = snapshot.history;
  if (history.imu.size() > imu_capacity) return FieldFault{"imu", "are more than an engine keeps"};
  if (history.fixes.size() + history.headings.size() > aiding_capacity) {
    return FieldFault{"fixes", "and headings are more than an engine keeps"};
  }
  TimeNs before_ns = history.base.time_ns;
  for (const ImuMeasurement& imu : history.imu) {
    if (imu.time_ns < before_ns) return FieldFault{"imu", "has times that go backward"};
    before_ns = imu.time_ns;
  }
  for (const FixMeasurement& fix : history.fixes) {
    if (turn_of(fix) < history.base.time_ns) return FieldFault{"fixes", "begin before the state"};
    if (fix.has_covariance && Eigen::LLT<Matrix3d>(fix.covariance_world_m2).info() != Eigen::Success) {
      return FieldFault{"fixes", "have a matrix that is not a covariance"};
    }
  }
  for (const HeadingMeasurement& heading : history.headings) {
    if (turn_of(heading) < history.base.time_ns) return FieldFault{"headings", "begin before the state"};
  }
  return std::nullopt;
}

}  // namespace sonopose::estimation::kalman
