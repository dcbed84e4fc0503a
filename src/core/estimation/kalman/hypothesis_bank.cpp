#include "estimation/kalman/state_internal.hpp"
#include <sonopose/estimation/kalman/hypothesis_bank.hpp>

#include <algorithm>
#include <utility>

namespace sonopose::estimation::kalman {

void inflate(Filter& filter, const CovarianceInflation& inflation) {
  filter.add_variance(at_velocity, Vector3d::Constant(square(inflation.velocity_mps)));
  filter.add_variance(at_attitude, Vector3d::Constant(square(inflation.tilt_rad)));
  filter.add_yaw_variance(square(inflation.yaw_rad));
  filter.add_variance(at_gyro_bias, Vector3d::Constant(square(inflation.gyro_bias_radps)));
  filter.add_variance(at_accel_bias, Vector3d::Constant(square(inflation.accel_bias_mps2)));
}

const ImuModelParameters& parameters_of(ImuModel model) {
  // A wrong sensor has been wrong for some tenths of a second before it is found.
  constexpr double wrong_mps = 0.2;
  // The rougher the IMU proves to be, the sooner its integral is worthless.
  static constexpr std::array<ImuModelParameters, 11> models{{
      {.noise = {}, .inflation = {}, .dead_reckoning_mps_rts = 1.5},
      {.noise = {.gyro_radps_rthz = 2.4e-3, .gyro_bias_radps_rts = 1e-3},
       .inflation = {},
       .dead_reckoning_mps_rts = 1.0},
      {.noise = {.accel_mps2_rthz = 0.15, .gyro_radps_rthz = 2.4e-3},
       .inflation = {},
       .dead_reckoning_mps_rts = 0.3},
      {.noise = {.gyro_radps_rthz = 2.4e-3, .accel_bias_mps2_rts = 4e-3, .gyro_bias_radps_rts = 0.03},
       .inflation = {},
       .dead_reckoning_mps_rts = 1.0},
      {.noise = {.gyro_radps_rthz = 2.4e-3, .gyro_bias_radps_rts = 1e-3},
       .inflation = {},
       .dead_reckoning_mps_rts = 1.0,
       .clock_offset_std_s = 0.15},
      {.noise = {.gyro_radps_rthz = 2.4e-3, .gyro_bias_radps_rts = 1e-3},
       .inflation = {},
       .dead_reckoning_mps_rts = 1.0},
      {.noise = {.gyro_radps_rthz = 2.4e-3, .gyro_bias_radps_rts = 1e-3},
       .inflation = {},
       .dead_reckoning_mps_rts = 1.0},
      {.noise = {.accel_mps2_rthz = 0.15, .gyro_radps_rthz = 0.2, .gyro_bias_radps_rts = 0.2},
       .inflation = {.velocity_mps = wrong_mps,
                     .tilt_rad = radians(2.0),
                     .yaw_rad = radians(10.0),
                     .gyro_bias_radps = 0.3},
       .dead_reckoning_mps_rts = 0.3},
      {.noise = {.accel_mps2_rthz = 1.5, .gyro_radps_rthz = 2.4e-3, .accel_bias_mps2_rts = 2.0},
       .inflation = {.velocity_mps = wrong_mps, .accel_bias_mps2 = 1.0},
       .dead_reckoning_mps_rts = 0.3},
      {.noise = {.accel_mps2_rthz = 3.0, .gyro_radps_rthz = 0.05},
       .inflation =
           {.velocity_mps = 1.0, .tilt_rad = radians(5.0), .yaw_rad = radians(15.0), .gyro_bias_radps = 0.1},
       .dead_reckoning_mps_rts = 1.5},
      {.noise = {.gyro_radps_rthz = 2.4e-3, .gyro_bias_radps_rts = 1e-3},
       .inflation =
           {.velocity_mps = 0.05, .tilt_rad = radians(6.0), .yaw_rad = radians(10.0), .accel_bias_mps2 = 0.1},
       .wrong_for_s = 0.4,
       .dead_reckoning_mps_rts = 1.0},
  }};
  return models[static_cast<std::size_t>(model)];
}

void set_imu_model(Hypothesis& hypothesis, ImuModel model) {
  hypothesis.imu = model;
  hypothesis.filter.ignores_force = model == ImuModel::distrusts_imu;
  if (model == ImuModel::wrong_velocities) hypothesis.filter.scale = {};  // learned from velocities
  inflate(hypothesis.filter, parameters_of(model).inflation);
  hypothesis.filter.apply_past_errors(parameters_of(model).wrong_for_s);
  const double offset_std_s = parameters_of(model).clock_offset_std_s;
  if (offset_std_s > 0.0 && !hypothesis.filter.estimates_delay()) {
    hypothesis.filter.estimate_delay(square(offset_std_s));
  }
}

HypothesisBank& HypothesisBank::operator=(const HypothesisBank& other) {
  if (!other.hypotheses.empty()) reserve();
  hypotheses = other.hypotheses;
  best_index = other.best_index;
  return *this;
}

void HypothesisBank::clear() {
  hypotheses.clear();
  best_index = 0;
}

const Hypothesis* HypothesisBank::find(ImuModel model) const {
  const auto found = std::find_if(begin(), end(), [model](const Hypothesis& each) {
    return each.track == Track::followed && each.imu == model;
  });
  return found == end() ? nullptr : &*found;
}

Hypothesis* HypothesisBank::find(ImuModel model) {
  const Hypothesis* const found = std::as_const(*this).find(model);
  return found == nullptr ? nullptr : &(*this)[index_of(*found)];
}

Hypothesis* HypothesisBank::find(Track track) {
  const auto found =
      std::find_if(begin(), end(), [track](const Hypothesis& each) { return each.track == track; });
  return found == end() ? nullptr : &*found;
}

Hypothesis& HypothesisBank::spawn(const Hypothesis& hypothesis) {
  reserve();
  hypotheses.push_back(hypothesis);
  return hypotheses.back();
}

void HypothesisBank::remove(const Hypothesis* hypothesis) {
  const int index = index_of(*hypothesis);
  const int last = size() - 1;
  if (index != last) (*this)[index] = (*this)[last];
  hypotheses.pop_back();
  if (best_index == index) {
    best_index = 0;
  } else if (best_index == last) {
    best_index = index;
  }
}

void HypothesisBank::remove(Track track) {
  for (const Hypothesis* found = find(track); found != nullptr; found = find(track)) remove(found);
}

void HypothesisBank::follow(const Filter& track) {
  const Hypothesis followed{.filter = track};  // `track` may belong to a hypothesis
  const ImuModel model = is_distrustful(best().imu) ? ImuModel::rough : best().imu;
  remove(Track::followed);
  for (int i = 0; i < closed_model_count; ++i) {
    set_imu_model(spawn(followed), static_cast<ImuModel>(i));
  }
  if (static_cast<int>(model) >= closed_model_count) set_imu_model(spawn(followed), model);
  best_index = index_of(*find(model));
}

}  // namespace sonopose::estimation::kalman
