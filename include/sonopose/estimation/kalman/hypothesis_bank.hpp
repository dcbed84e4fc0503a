#pragma once
/// \file
/// Hypotheses about the motion: filters that differ in their assumptions about IMU and fixes.

#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/samples/field_fault.hpp>

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sonopose::estimation::kalman {

/// Trust of a hypothesis in the IMU.
enum class ImuModel : std::uint8_t {
  quiet,
  rough_gyro,
  rough,             ///< vibration also shakes the accelerometer
  drifting_gyro,     ///< the bias of the gyroscope changes within seconds
  other_clock,       ///< IMU stamps are from another clock than those of fixes and headings
  wrong_headings,    ///< headings are wrong: its yaw follows from the motion alone
  wrong_velocities,  ///< velocities of the body are wrong: it uses none
  distrusts_gyro,    ///< hardly trusts the gyroscope
  distrusts_accel,   ///< hardly trusts the accelerometer
  distrusts_imu,     ///< hardly trusts either: follows the fixes alone
  jumped             ///< its attitude or bias has jumped; trusts it again from then on
};

constexpr std::array<std::string_view, 11> choices_of(ImuModel /*model*/) {
  return {"quiet",          "rough_gyro",       "rough",          "drifting_gyro",   "other_clock",
          "wrong_headings", "wrong_velocities", "distrusts_gyro", "distrusts_accel", "distrusts_imu",
          "jumped"};
}

constexpr bool is_distrustful(ImuModel model) {
  return model >= ImuModel::distrusts_gyro;
}

/// Track of fixes that a hypothesis attributes to the body.
enum class Track : std::uint8_t {
  followed,  ///< track of the pose
  other,     ///< track of the fixes that the best hypothesis rejects
  turned,    ///< the other track, in a map that has turned
  former     ///< track that was followed before
};

constexpr std::array<std::string_view, 4> choices_of(Track /*track*/) {
  return {"followed", "other", "turned", "former"};
}

/// Standard deviations added to a hypothesis when it assumes a model.
struct CovarianceInflation {
  double velocity_mps = 0;
  double tilt_rad = 0;
  double yaw_rad = 0;
  double gyro_bias_radps = 0;
  double accel_bias_mps2 = 0;
};

/// Adds the variances of `inflation`.
void inflate(Filter& filter, const CovarianceInflation& inflation);

/// Parameters of a model of the IMU.
struct ImuModelParameters {
  ProcessNoise noise;
  CovarianceInflation inflation;
  double wrong_for_s = 0;             ///< time for which attitude and biases were wrong before it starts
  double dead_reckoning_mps_rts = 0;  ///< density of the zero-velocity measurement without fixes
  double clock_offset_std_s = 0;  ///< deviation of the delay error that it estimates; 0: as the settings say
};

[[nodiscard]] const ImuModelParameters& parameters_of(ImuModel model);

struct Hypothesis {
  ImuModel imu = ImuModel::quiet;
  Track track = Track::followed;
  Filter filter;
  double score = 0;  ///< log-likelihood of about the last sixty fixes
  double evidence =
      0;  ///< log-likelihood of about the last seven fixes and their headings, each of which may be wrong
  int explained = 0;         ///< explained fixes since it began
  int explained_in_row = 0;  ///< consecutive explained fixes and headings
  int missed_in_row = 0;     ///< consecutive missed fixes
  int headings = 0;          ///< headings that agreed with a turned map
  TimeNs began_ns = 0;       ///< start of the track; for a former one, of the track that replaced it
  TimeNs explained_ns = 0;   ///< time of the last explained fix

  bool operator==(const Hypothesis&) const = default;
};

/// Makes a hypothesis assume this model of the IMU, and inflates its covariance accordingly.
void set_imu_model(Hypothesis& hypothesis, ImuModel model);

inline constexpr int closed_model_count =
    5;                                 ///< models that trust the IMU, with one hypothesis each while tracking
inline constexpr int start_count = 8;  ///< directions from which an unknown yaw is searched

/// All hypotheses, and the best of the followed track. A plain value with memory for all from its first
/// hypothesis on, so that an assignment allocates nothing.
struct HypothesisBank {
  static constexpr int capacity =
      static_cast<int>(choices_of(ImuModel{}).size()) + 2;  ///< the models, another and a former track

  std::vector<Hypothesis> hypotheses;
  int best_index = 0;

  HypothesisBank() = default;
  HypothesisBank(const HypothesisBank& other) {
    reserve();
    *this = other;
  }
  HypothesisBank& operator=(const HypothesisBank& other);
  ~HypothesisBank() = default;
  bool operator==(const HypothesisBank&) const = default;

  /// Allocates memory for all hypotheses.
  void reserve() { hypotheses.reserve(capacity); }
  void clear();

  [[nodiscard]] int size() const { return static_cast<int>(hypotheses.size()); }
  [[nodiscard]] Hypothesis& operator[](int i) { return hypotheses[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Hypothesis& operator[](int i) const { return hypotheses[static_cast<std::size_t>(i)]; }
  [[nodiscard]] auto begin() { return hypotheses.begin(); }
  [[nodiscard]] auto end() { return hypotheses.end(); }
  [[nodiscard]] auto begin() const { return hypotheses.begin(); }
  [[nodiscard]] auto end() const { return hypotheses.end(); }
  [[nodiscard]] Hypothesis& best() { return (*this)[best_index]; }
  [[nodiscard]] const Hypothesis& best() const { return (*this)[best_index]; }
  [[nodiscard]] int index_of(const Hypothesis& hypothesis) const {
    return static_cast<int>(&hypothesis - hypotheses.data());
  }

  /// Hypothesis of this model on the followed track; null: none.
  [[nodiscard]] Hypothesis* find(ImuModel model);
  [[nodiscard]] const Hypothesis* find(ImuModel model) const;
  /// Hypothesis on a track that is not followed; null: none.
  [[nodiscard]] Hypothesis* find(Track track);

  /// Adds a copy. Requires that there is room for it.
  Hypothesis& spawn(const Hypothesis& hypothesis);
  void remove(const Hypothesis* hypothesis);
  /// Removes the hypotheses on this track.
  void remove(Track track);
  /// Follows this track, with one hypothesis per trusting model of the IMU. Other tracks live on.
  void follow(const Filter& track);
};

void for_each_field(IsFieldsOf<Hypothesis> auto& hypothesis, const auto& visit) {
  visit("imu", hypothesis.imu);
  visit("track", hypothesis.track);
  for_each_field(hypothesis.filter, visit);
  visit("score", hypothesis.score);
  visit("evidence", hypothesis.evidence);
  visit("explained", hypothesis.explained);
  visit("explained_in_row", hypothesis.explained_in_row);
  visit("missed_in_row", hypothesis.missed_in_row);
  visit("headings", hypothesis.headings);
  visit("began_ns", hypothesis.began_ns);
  visit("explained_ns", hypothesis.explained_ns);
}

void for_each_field(IsFieldsOf<HypothesisBank> auto& bank, const auto& visit) {
  visit("hypotheses", bank.hypotheses);
  visit("best_index", bank.best_index);
}

}  // namespace sonopose::estimation::kalman
