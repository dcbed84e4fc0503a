#include "evaluation/run.hpp"

#include "evaluation/comparison.hpp"
#include "evaluation/digest.hpp"
#include <sonopose/estimation/documented/admission.hpp>
#include <sonopose/estimation/documented/engine.hpp>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace sonopose::evaluation {
namespace {

/// Collects the output of an engine.
class Results {
public:
  Results(const recording::SensorLog& log, const RunOptions& options, const Observer& observer)
      : observer_(observer),
        comparison_(log.truth, available_at_ns(log.events.front()) + to_ns(options.after_s)) {
    result_.has_truth = !log.truth.empty();
  }

  void add(const UltrasonicFix& fix) { comparison_.add(fix); }

  void add(const FusedPose& pose) {
    ++result_.poses;
    digest_.add(pose);
    if (result_.has_truth) comparison_.add(pose);
    if (observer_.on_pose) observer_.on_pose(pose);
  }

  void add(const FixReport& report) {
    result_.fix_flags.add(report.flags);
    if (observer_.on_report) observer_.on_report(report);
  }

  Digest& digest() { return digest_; }
  RunResult& result() { return result_; }

  RunResult finished() {
    result_.fused = comparison_.fused();
    result_.last_fix_m = comparison_.last_fix_m();
    result_.extrapolated_m = comparison_.extrapolated_m();
    result_.state_hash = digest_.text();
    return std::move(result_);
  }

private:
  const Observer& observer_;
  Comparison comparison_;
  Digest digest_;
  RunResult result_;
};

/// The documented fusion.
class FusionRun {
public:
  FusionRun(const RunOptions& options, Results& results) : engine_(options.settings), results_(results) {
    if (!options.start) return;
    engine_.restore(options.start->snapshot);
    before_ = options.start->snapshot.counters;
  }

  void on(const Event& event) {
    estimation::documented::deliver(
        engine_, event, [this](const FusedPose& pose) { results_.add(pose); },
        [this](const FixReport& report) { results_.add(report); });
  }

  void finish() {
    results_.digest().add(engine_.state());
    results_.result().end.snapshot = engine_.snapshot();
    const estimation::documented::Counters& now = engine_.counters();
    results_.result().counters = {.imu_samples = now.imu_samples - before_.imu_samples,
                                  .fixes_used = now.fixes_used - before_.fixes_used,
                                  .fixes_rejected = now.fixes_rejected - before_.fixes_rejected,
                                  .headings = now.headings - before_.headings,
                                  .samples_invalid = now.samples_invalid - before_.samples_invalid,
                                  .imu_gaps = now.imu_gaps - before_.imu_gaps};
  }

private:
  estimation::documented::Engine engine_;
  estimation::documented::Counters before_;
  Results& results_;
};

/// IMU only. Ignores fixes and headings.
class StrapdownRun {
public:
  StrapdownRun(const TruthSample& start, const RunOptions& options, Results& results)
      : settings_(options.settings),
        strapdown_({start.time_ns, start.position_world_m, start.velocity_world_mps, start.q_body_to_world},
                   options.strapdown_rule),
        results_(results) {}

  void on(const Event& event) {
    const auto* imu = std::get_if<ImuSample>(&event);
    if (imu == nullptr) return;
    estimation::documented::Counters& counters = results_.result().counters;
    if (!estimation::documented::admission::admits(settings_.admission, last_imu_ns_, *imu)) {
      ++counters.samples_invalid;
      return;
    }
    const double silence_s = seconds_between(last_imu_ns_, imu->sensor_time_ns);
    if (last_imu_ns_ != 0 && silence_s > settings_.outage.imu_gap_s) ++counters.imu_gaps;
    last_imu_ns_ = imu->sensor_time_ns;
    ++counters.imu_samples;
    strapdown_.on(*imu);
    if (imu->sensor_time_ns >= strapdown_.state().time_ns) results_.add(pose_at(*imu));
  }

  void finish() {}

private:
  [[nodiscard]] FusedPose pose_at(const ImuSample& imu) const {
    FusedPose pose;
    pose.address = imu.address;
    pose.sequence = imu.sequence;
    pose.time_ns = strapdown_.state().time_ns;
    pose.position_world_m = strapdown_.state().position_world_m;
    pose.q_body_to_world = strapdown_.state().q_body_to_world;
    pose.velocity_world_mps = strapdown_.state().velocity_world_mps;
    pose.angular_velocity_body_radps = imu.angular_velocity_body_radps;
    pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
    pose.imu_sensor_time_ns = imu.sensor_time_ns;
    return pose;
  }

  const settings::Settings& settings_;
  estimation::Strapdown strapdown_;
  Results& results_;
  TimeNs last_imu_ns_ = 0;
};

/// Feeds the engine with the recording's events between the start and the end given by the options.
template <class Engine>
RunResult run_through(const recording::SensorLog& log, const RunOptions& options, Results& results,
                      Engine& engine) {
  RunResult& result = results.result();
  const TimeNs begin_ns = available_at_ns(log.events.front());
  std::uint64_t last_sequence = options.start ? options.start->sequence : 0;
  const std::uint64_t skipped = last_sequence;
  std::optional<TimeNs> first_ns;
  TimeNs last_ns = 0;
  const auto is_over = [&](const Event& event) {
    return options.until_s && seconds_between(begin_ns, available_at_ns(event)) > *options.until_s;
  };
  TimeNs last_imu_ns = 0;
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    const Event& event = log.events[i];
    // A single late event may have a wrong time stamp.
    if (is_over(event) && (i + 1 == log.events.size() || is_over(log.events[i + 1]))) break;
    const TimeNs now_ns = available_at_ns(event);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) results.add(*fix);
    if (sequence_of(event) <= skipped) continue;
    engine.on(event);
    ++result.events;
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      if (imu->sensor_time_ns < last_imu_ns) ++result.imu_stamps_back;
      last_imu_ns = imu->sensor_time_ns;
    }
    last_sequence = sequence_of(event);
    if (!first_ns) first_ns = now_ns;
    last_ns = std::max(last_ns, now_ns);
  }
  if (first_ns) result.duration_s = seconds_between(*first_ns, last_ns);
  engine.finish();
  result.end.sequence = last_sequence;
  result.end.beacon = address_of(log.events.front());
  result.end.first_event_ns = begin_ns;
  return results.finished();
}

}  // namespace

std::optional<TruthSample> first_complete_truth(const recording::SensorLog& log) {
  const auto complete = [](const TruthSample& truth) {
    return truth.position_world_m.allFinite() && truth.velocity_world_mps.allFinite() &&
           truth.q_body_to_world.coeffs().allFinite() && truth.q_body_to_world.norm() > 0.0;
  };
  const auto found = std::find_if(log.truth.begin(), log.truth.end(), complete);
  return found == log.truth.end() ? std::nullopt : std::optional(*found);
}

RunResult run(const recording::SensorLog& log, const RunOptions& options, const Observer& observer) {
  if (log.events.empty()) throw std::invalid_argument("the recording has no samples");
  if (options.start && options.start->sequence > log.events.size()) {
    throw std::invalid_argument("the saved state follows event " + std::to_string(options.start->sequence) +
                                ", but the recording has only " + std::to_string(log.events.size()) +
                                " events: the state belongs to another recording");
  }
  Results results(log, options, observer);
  if (options.engine == EngineKind::fusion) {
    FusionRun engine(options, results);
    return run_through(log, options, results, engine);
  }
  const auto start = first_complete_truth(log);
  if (!start) {
    throw std::invalid_argument(
        "the strapdown engine starts from the truth, and the recording has no truth.csv with a row that "
        "contains position, attitude and velocity");
  }
  StrapdownRun engine(*start, options, results);
  return run_through(log, options, results, engine);
}

}  // namespace sonopose::evaluation
