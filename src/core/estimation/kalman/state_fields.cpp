#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/kalman/state_fields.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace sonopose::estimation::kalman {
namespace {

/// Searches all records for counts and times with which arithmetic could overflow.
struct RangeCheck {
  std::optional<FieldFault>& fault;

  void operator()(const char* name, int count) const {
    constexpr int max_count = 1'000'000'000;
    if (count < 0 || count > max_count) report(name, "is not between 0 and 1e9");
  }
  void operator()(const char* name, TimeNs time_ns) const {
    if (time_ns != 0 && !aiding::admission::is_time(time_ns)) report(name, "is not a valid time");
  }
  template <class Record>
  void operator()(const char* /*name*/, const std::vector<Record>& records) const {
    for (const Record& record : records) for_each_field(record, *this);
  }
  template <class Record>
  void operator()(const char* /*name*/, const AtMostOne<Record>& record) const {
    if (record) for_each_field(*record, *this);
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
  using Joint = Eigen::Matrix<double, state_size + 2, state_size + 2>;  // including delay and scale
  const VelocityScale velocity_scale = filter.scale ? *filter.scale : VelocityScale{};
  Joint joint;
  joint << filter.covariance, filter.delay_covariance, velocity_scale.covariance,
      filter.delay_covariance.transpose(), filter.delay_variance_s2, velocity_scale.delay_covariance_s,
      velocity_scale.covariance.transpose(), velocity_scale.delay_covariance_s, velocity_scale.variance;
  if (joint != joint.transpose() || !(joint.diagonal().minCoeff() >= 0.0)) return false;
  // Correlations, with a margin for rounding.
  constexpr double margin = 1e-9;
  const Joint scale = joint.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse().asDiagonal();
  Joint correlation = scale * joint * scale;
  correlation.diagonal().array() += margin;
  return Eigen::LLT<Joint>(correlation).info() == Eigen::Success;
}

bool is_trend(const Trend& trend) {
  return trend.weight >= 0.0 && trend.time_squares_s2 >= 0.0;
}

/// Checks the intervals and durations that the engine has learned.
std::optional<FieldFault> find_timing_fault(const State& state) {
  const auto is_between = [](double value, double max) { return value >= 0.0 && value <= max; };
  constexpr double max_gap_s = 5.0;  // largest value of outage.imu_gap_s
  if (!is_between(state.imu.nominal_imu_period_s, max_gap_s)) {
    return FieldFault{"nominal_imu_period_s", "is not between 0 and 5 s"};
  }
  if (!is_between(state.headings.interval_s, max_heading_interval_s)) {
    return FieldFault{"interval_s", "is not between 0 and 10 s"};
  }
  if (!(state.wrong_tracks.longest_s >= 0.0)) return FieldFault{"longest_s", "is negative or no number"};
  if (state.default_position.fixes >= 2 * static_cast<int>(aiding::DefaultPosition::capacity)) {
    return FieldFault{"default_position", "has more fixes than twice the number of places"};
  }
  if (!(state.slow_error.mean_m2 >= 0.0 && state.slow_error.power_m4 >= 0.0))
    return FieldFault{"slow_error", "has a negative variance"};
  if (!is_trend(state.rest.fixes)) return FieldFault{"rest.fixes", "have a negative weight or square"};
  if (!is_trend(state.rest.headings)) return FieldFault{"rest.headings", "have a negative weight or square"};
  return std::nullopt;
}

std::optional<FieldFault> find_noise_fault(const MeasurementNoise& noise) {
  const auto is_variance = [](const AdaptiveVariance& any) {
    return any.variance >= 0.0 && any.samples >= 0.0 && any.motion_variance >= 0.0;
  };
  const auto is_positive = [&](const AdaptiveVariance& any) {
    return is_variance(any) && any.variance > 0.0 && any.motion_variance > 0.0;
  };
  if (!std::all_of(noise.bins.begin(), noise.bins.end(), [&](const MeasurementNoise::Bin& bin) {
        return is_variance(bin.horizontal_m2) && is_variance(bin.vertical_m2);
      })) {
    return FieldFault{"bins", "have a negative variance"};
  }
  if (!is_positive(noise.any_quality.horizontal_m2) || !is_positive(noise.any_quality.vertical_m2)) {
    return FieldFault{"any_quality", "has a variance that is not positive"};
  }
  const FixScatter& scatter = noise.scatter;
  if (!(scatter.samples >= 0 && scatter.motion_m2 >= 0.0 && scatter.variance_m2.minCoeff() >= 0.0 &&
        scatter.resolution_m.minCoeff() >= 0.0 && scatter.repeats.minCoeff() >= 0.0)) {
    return FieldFault{"scatter", "has a negative number"};
  }
  if (!is_positive(noise.heading_rad2)) return FieldFault{"heading_rad2", "is not positive"};
  return std::nullopt;
}

std::optional<FieldFault> find_bank_fault(const State& state) {
  const HypothesisBank& bank = state.bank;
  if (bank.size() > HypothesisBank::capacity)
    return FieldFault{"hypotheses", "are more than an engine keeps"};
  if ((state.phase == Phase::waiting) != (bank.size() == 0)) {
    return FieldFault{"hypotheses", "are none although the estimate has begun, or the other way round"};
  }
  if (bank.best_index >= std::max(bank.size(), 1))
    return FieldFault{"best_index", "is not that of a hypothesis"};
  if (bank.size() == 0) return std::nullopt;
  if (bank.best().track != Track::followed) return FieldFault{"best_index", "is not of the followed track"};
  if (!std::all_of(bank.begin(), bank.end(),
                   [](const Hypothesis& each) { return is_covariance(each.filter); })) {
    return FieldFault{"hypotheses", "have a matrix that is not a covariance"};
  }
  for (int i = 0; state.phase == Phase::tracking && i < closed_model_count; ++i) {
    const auto of_model = std::count_if(bank.begin(), bank.end(), [i](const Hypothesis& each) {
      return each.track == Track::followed && each.imu == static_cast<ImuModel>(i);
    });
    if (of_model != 1) return FieldFault{"hypotheses", "do not have one of each model of the IMU"};
  }
  const auto followed = std::count_if(bank.begin(), bank.end(),
                                      [](const Hypothesis& each) { return each.track == Track::followed; });
  const auto max_followed = state.phase == Phase::tracking ? choices_of(ImuModel{}).size() : start_count + 1U;
  if (static_cast<std::size_t>(followed) > max_followed) {
    return FieldFault{"hypotheses", "are more on the followed track than an engine keeps"};
  }
  for (const Track track : {Track::other, Track::former}) {
    const auto on_track = std::count_if(bank.begin(), bank.end(), [track](const Hypothesis& each) {
      return (each.track == Track::turned ? Track::other : each.track) == track;
    });
    if (on_track > 1) return FieldFault{"hypotheses", "have several on one track that is not followed"};
  }
  return std::nullopt;
}

std::optional<FieldFault> find_fault(const State& state) {
  if (state.time_ns < state.imu.time_ns) return FieldFault{"time_ns", "is before the latest sample"};
  if (!(state.fixes.trust >= 0.0 && state.fixes.trust <= 1.0)) {
    return FieldFault{"trust", "is not between 0 and 1"};
  }
  if (state.known && !aiding::is_plausible(*state.known))
    return FieldFault{"known", "has a value that no sensor has"};
  std::optional<FieldFault> fault = find_bank_fault(state);
  if (!fault) fault = find_noise_fault(state.noise);
  if (!fault) fault = find_timing_fault(state);
  return fault;
}

}  // namespace

std::optional<FieldFault> find_fault(const Snapshot& snapshot) {
  std::optional<FieldFault> fault;
  for_each_field(snapshot, RangeCheck{fault});
  if (!fault) fault = find_fault(snapshot.history.base);
  if (fault) return fault;
  const History& history = snapshot.history;
  if (history.imu.size() > imu_capacity) return FieldFault{"imu", "are more than an engine keeps"};
  if (history.fixes.size() + history.headings.size() + history.twists.size() > aiding_capacity) {
    return FieldFault{"fixes", "and other measurements are more than an engine keeps"};
  }
  TimeNs before_ns = history.base.imu.time_ns;
  for (const ImuMeasurement& imu : history.imu) {
    if (imu.time_ns < before_ns) return FieldFault{"imu", "has times that go backward"};
    before_ns = imu.time_ns;
  }
  for (const FixMeasurement& fix : history.fixes) {
    if (order_key(fix) < history.base.imu.time_ns) return FieldFault{"fixes", "begin before the state"};
    if (fix.has_covariance && Eigen::LLT<Matrix3d>(fix.covariance_world_m2).info() != Eigen::Success) {
      return FieldFault{"fixes", "have a matrix that is not a covariance"};
    }
  }
  for (const HeadingMeasurement& heading : history.headings) {
    if (order_key(heading) < history.base.imu.time_ns)
      return FieldFault{"headings", "begin before the state"};
  }
  for (const TwistMeasurement& twist : history.twists) {
    if (order_key(twist) < history.base.imu.time_ns) return FieldFault{"twists", "begin before the state"};
  }
  return std::nullopt;
}

}  // namespace sonopose::estimation::kalman
