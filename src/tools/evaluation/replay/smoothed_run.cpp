#include "evaluation/replay/smoothed_run.hpp"

#include <sonopose/estimation/offline/judgement.hpp>
#include <sonopose/estimation/offline/smoother.hpp>

#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace sonopose::evaluation {
namespace {

using estimation::offline::Segment;
using estimation::offline::SmoothedPose;

void check_options(const RunOptions& options) {
  if (options.strapdown || options.settings.engine.engine != settings::EngineKind::kalman) {
    throw std::invalid_argument("only the Kalman engine can be smoothed: set fusion.engine = \"kalman\"");
  }
  if (options.start) {
    throw std::invalid_argument("a smoothed run starts with the recording and cannot continue a saved state");
  }
  if (options.settings.planar.planar) {
    throw std::invalid_argument("the smoother does not support planar motion: set motion.planar = false");
  }
  if (options.settings.delay.estimate) {
    throw std::invalid_argument(
        "the smoother does not estimate the delay: set kalman.delay.estimate = false");
  }
}

void replace(FusedPose& pose, const SmoothedPose& smoothed) {
  constexpr std::uint32_t of_measurements = status_stale | status_frozen_track | status_imu_gap |
                                            status_low_trust | status_imu_inconsistent |
                                            status_fixes_inconsistent;
  pose.position_world_m = smoothed.position_world_m;
  pose.velocity_world_mps = smoothed.velocity_world_mps;
  pose.q_body_to_world = smoothed.q_body_to_world;
  pose.angular_velocity_body_radps += pose.gyro_bias_body_radps - smoothed.gyro_bias_body_radps;
  pose.gyro_bias_body_radps = smoothed.gyro_bias_body_radps;
  pose.pose_covariance = smoothed.pose_covariance;
  pose.velocity_covariance = smoothed.velocity_covariance;
  pose.status &= of_measurements;
}

/// The outputs of the engine, in order.
using Outputs = std::vector<std::variant<FusedPose, FixReport>>;

/// Replaces the engine's poses by the smoothed ones, and passes them on.
class Replaying {
public:
  Replaying(const Outputs& outputs, const Observer& observer, Scorer& engine, Scorer& smoothed)
      : next_(outputs.begin()),
        end_(outputs.end()),
        observer_(observer),
        engine_(engine),
        smoothed_(smoothed) {}

  /// Smoothed poses belong to some of the samples, in the order of the outputs.
  void add(const SmoothedPose& smoothed) {
    for (; next_ != end_; ++next_) {
      const auto* pose = std::get_if<FusedPose>(&*next_);
      if (pose == nullptr) {
        pass_report();
      } else if (pose->time_ns == smoothed.time_ns) {
        break;
      }
    }
    if (next_ == end_) return;
    FusedPose pose = *std::get_if<FusedPose>(&*next_++);
    engine_.add(pose);
    replace(pose, smoothed);
    smoothed_.add(pose);
    ++poses_;
    if (observer_.on_pose) observer_.on_pose(pose);
  }

  void finish() {
    for (; next_ != end_; ++next_) pass_report();
  }

  [[nodiscard]] std::uint64_t poses() const { return poses_; }

private:
  void pass_report() const {
    const auto* report = std::get_if<FixReport>(&*next_);
    if (report != nullptr && observer_.on_report) observer_.on_report(*report);
  }

  Outputs::const_iterator next_;
  Outputs::const_iterator end_;
  const Observer& observer_;
  Scorer& engine_;
  Scorer& smoothed_;
  std::uint64_t poses_ = 0;
};

}  // namespace

RunResult run_smoothed(const recording::SensorLog& log, const RunOptions& options, const Observer& observer) {
  check_options(options);
  Outputs outputs;
  RunResult result = run(log, options,
                         {[&outputs](const FusedPose& pose) { outputs.emplace_back(pose); },
                          [&outputs](const FixReport& report) { outputs.emplace_back(report); }});
  const auto events = std::span(log.events).first(result.events);
  const std::vector<Segment> segments = estimation::offline::judged(options.settings, events);
  Smoothing smoothing;
  smoothing.noise = estimation::offline::fitted_noise(options.settings, segments);
  const TimeNs from_ns = available_at_ns(log.events.front()) + to_ns(options.after_s);
  Scorer engine(log.truth, from_ns);
  Scorer smoothed(log.truth, from_ns);
  Replaying replaying(outputs, observer, engine, smoothed);
  for (const Segment& segment : segments) {
    for (const SmoothedPose& pose :
         estimation::offline::smoothed(options.settings, segment, smoothing.noise)) {
      replaying.add(pose);
    }
  }
  replaying.finish();
  smoothing.engine = engine.score();
  result.fused = smoothed.score();
  result.poses = replaying.poses();
  result.smoothing = std::move(smoothing);
  return result;
}

}  // namespace sonopose::evaluation
