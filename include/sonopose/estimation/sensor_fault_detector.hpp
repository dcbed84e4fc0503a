#pragma once
/// \file
/// Detects, beside the engine of one beacon, faults of the IMU that need no filter to be seen.

#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

namespace sonopose::estimation {

/// Compares the readings with gravity, each other, headings and fixes. It has a fixed size and does not
/// allocate. It is no part of an estimator's snapshot: it is empty after a restart.
///
/// It finds within seconds: an axis that keeps its value, a unit that contradicts gravity, a gyroscope of the
/// wrong sign (by headings, or by the direction of travel), a mount that is turned (by the accelerations, or
/// by headings that the engine does not follow), and stamps of the IMU that are ahead of those of the
/// headings.
class SensorFaultDetector {
public:
  explicit SensorFaultDetector(const settings::Settings& settings) { configure(settings); }

  void configure(const settings::Settings& settings);
  /// Takes an event before the engine does.
  void on(const Event& event);
  /// Takes the pose of the engine at the latest IMU sample.
  void on(const FusedPose& pose);

  /// Bits of PoseStatus to add to that of a pose at this time.
  [[nodiscard]] std::uint32_t status(TimeNs time_ns) const {
    return (time_ns < faulty_until_ns_ ? std::uint32_t{status_imu_inconsistent} : 0U) |
           (time_ns < other_clock_until_ns_ ? std::uint32_t{status_fixes_inconsistent} : 0U);
  }

private:
  /// Readings of one to two seconds.
  struct Block {
    TimeNs begin_ns = 0;
    std::size_t samples = 0;
    std::size_t fast = 0;                   ///< faster than a vehicle turns
    std::array<std::size_t, 6> repeated{};  ///< by axis: equal to the value before; gyroscope first
    double force_sum_mps2 = 0;
    Quaterniond q_body_to_begin = Quaterniond::Identity();  ///< by the gyroscope
    Vector3d force_sum_begin_mps2 = Vector3d::Zero();       ///< in the body axes at its beginning
  };

  /// Integrals of the IMU at a pose.
  struct Moment {
    TimeNs time_ns = 0;
    double turned_rad = 0;                 ///< by the gyroscope, about the vertical
    std::complex<double> moved_world_m{};  ///< by the accelerations alone, in the horizontal plane
    std::complex<double> facing_world{};   ///< direction of the body's x axis; zero if not known
  };

  /// A direction, continuous beyond ±π, and the turn of the gyroscope until then.
  struct Direction {
    TimeNs time_ns = 0;
    double direction_rad = 0;
    double turned_rad = 0;
  };

  struct Place {
    TimeNs time_ns = 0;
    std::complex<double> position_world_m{};
    std::complex<double> moved_world_m{};
  };

  /// Fading mean and variance of heading minus turn of the gyroscope, if its clock were off by a lag.
  struct Lag {
    double count = 0;
    double mean_rad = 0;
    double variance_rad2 = 0;
  };
  static constexpr int max_lags = 6;  // of 0.1 s, to either side

  /// The last elements, without allocation.
  template <class T, std::size_t capacity>
  class Ring {
  public:
    void add(const T& element) { elements_[count_++ % capacity] = element; }
    void clear() { count_ = 0; }
    [[nodiscard]] std::size_t size() const { return count_ < capacity ? count_ : capacity; }
    /// 0: the latest.
    [[nodiscard]] const T& back(std::size_t index) const {
      return elements_[(count_ - 1 - index) % capacity];
    }

  private:
    std::array<T, capacity> elements_{};
    std::size_t count_ = 0;
  };

  void on_imu(const ImuSample& imu);
  void on_fix(TimeNs time_ns, const UltrasonicFix& fix);
  void on_direction(TimeNs time_ns, double angle_rad, int min_turns);
  void on_place(const Place& place);
  void on_heading(TimeNs time_ns, double heading_rad);
  void judge_mount(TimeNs time_ns, double body_heading_rad);
  void judge_block(TimeNs time_ns);
  void judge_turn(const Direction& from, const Direction& middle, const Direction& to, int min_turns);
  [[nodiscard]] bool moment_at(TimeNs time_ns, Moment& moment) const;
  void fault(TimeNs time_ns);
  void restart();

  settings::DelaySettings delay_;
  calibration::Calibration calibration_;
  double mount_rad_ = 0;
  TimeNs faulty_until_ns_ = 0;
  TimeNs other_clock_until_ns_ = 0;
  TimeNs last_imu_ns_ = 0;
  std::array<double, 6> last_values_{};
  Block block_;
  int bad_blocks_ = 0;                           ///< consecutive blocks with an impossible force
  Vector3d force_body_mps2_ = Vector3d::Zero();  ///< mean of the last seconds
  double turned_rad_ = 0;
  std::complex<double> speed_world_mps_{};
  std::complex<double> moved_world_m_{};
  TimeNs last_pose_ns_ = 0;
  TimeNs known_since_ns_ = 0;  ///< since then the heading is known
  Vector3d last_force_body_mps2_ = Vector3d::Zero();
  Ring<Moment, 512> moments_;
  bool has_headings_ = false;
  int wrong_turns_ = 0;  ///< consecutive
  int right_turns_ = 0;
  double heading_rad_ = 0;  ///< latest, continuous beyond ±π
  std::array<Lag, 2 * max_lags + 1> lags_{};
  Ring<Direction, 64> directions_;
  Ring<Place, 64> places_;
  Vector3d tag_body_m_ = Vector3d::Zero();  ///< place of the one tag that is followed
  TimeNs tag_seen_ns_ = 0;
  std::complex<double>
      product_{};  ///< fading sum over changes of speed: by the IMU (conjugate) times by fixes
  double imu_square_ = 0;
  double fix_square_ = 0;
  double judged_ = 0;  ///< fading number of changes
  int turned_in_row_ = 0;
  TimeNs last_heading_ns_ = 0;
  TimeNs headings_wrong_ns_ = 0;  ///< since then all contradict the pose; 0: not now
};

}  // namespace sonopose::estimation
