#include "evaluation/replay/run.hpp"

#include "estimation/digest.hpp"
#include "evaluation/score/comparison.hpp"
#include <sonopose/estimation/aiding/height_check.hpp>
#include <sonopose/estimation/aiding/twist_problem.hpp>
#include <sonopose/estimation/sensor_fault_detector.hpp>
#include <sonopose/estimation/snapshot_fields.hpp>
#include <sonopose/samples/outputs.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sonopose::evaluation {

std::uint64_t digest_of(const Event& event) {
  estimation::Digest digest;
  digest.add(static_cast<std::uint64_t>(available_at_ns(event)));
  const auto add = [&digest](const Vector3d& value) {
    for (const double coordinate : value) digest.add(coordinate);
  };
  if (const auto* imu = std::get_if<ImuSample>(&event)) {
    add(imu->angular_velocity_body_radps);
    add(imu->specific_force_body_mps2);
  } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
    add(fix->position_world_m);
  } else if (const auto* heading = std::get_if<PairHeading>(&event)) {
    digest.add(heading->heading_world_rad);
  } else if (const auto* twist = std::get_if<TwistSample>(&event)) {
    add(twist->velocity_body_mps);
  }
  return digest.value();
}

namespace {

class Results {
public:
  Results(const recording::SensorLog& log, const RunOptions& options, const Observer& observer)
      : observer_(observer),
        judged_from_ns_(available_at_ns(log.events.front()) + to_ns(options.after_s)),
        comparison_(log.truth, judged_from_ns_),
        prediction_(judged_from_ns_, options.settings, log.wheel_speeds) {
    result_.has_truth = !log.truth.empty();
  }

  void add(const UltrasonicFix& fix) { comparison_.add(fix); }

  /// Takes an event before the estimator does.
  template <class... Estimator>
  void predict(const Event& event, const Estimator&... estimator) {
    prediction_.add(event, estimator...);
  }

  void add(const FusedPose& pose) {
    ++result_.poses;
    count_warnings(pose);
    digest_.add(pose);
    if (result_.has_truth) comparison_.add(pose);
    if (observer_.on_pose) observer_.on_pose(pose);
  }

  void add(const FixReport& report) {
    result_.fix_flags.add(report.flags);
    if ((report.flags & fix_used) == 0) result_.rejected_fix_flags.add(report.flags);
    result_.refusals.on(report);
    if (is_down_weighted(report)) ++result_.fixes_down_weighted;
    if (observer_.on_report) observer_.on_report(report);
  }

  void add(const estimation::EventResult& output) {
    prediction_.add(output);
    if (const auto* pose = std::get_if<FusedPose>(&output)) add(*pose);
    if (const auto* report = std::get_if<FixReport>(&output)) add(*report);
  }

  estimation::Digest& digest() { return digest_; }
  RunResult& result() { return result_; }

  RunResult finished() {
    result_.fused = comparison_.fused();
    result_.last_fix_m = comparison_.last_fix_m();
    result_.extrapolated_m = comparison_.extrapolated_m();
    result_.prediction = prediction_.score();
    result_.state_hash = digest_.text();
    return std::move(result_);
  }

private:
  void count_warnings(const FusedPose& pose) {
    if (pose.time_ns < judged_from_ns_) return;
    ++result_.judged_poses;
    for (const auto& [bit, name] : run_warnings) {
      if ((pose.status & bit) != 0U) ++result_.warned[bit];
    }
  }

  const Observer& observer_;
  TimeNs judged_from_ns_;
  Comparison comparison_;
  PredictionErrors prediction_;
  estimation::Digest digest_;
  RunResult result_;
};

strapdown::State strapdown_start(const recording::SensorLog& log) {
  const auto start = first_complete_truth(log);
  if (!start) {
    throw std::invalid_argument(
        "strapdown integration starts from the truth, and the recording has no truth.csv with a row that has "
        "position, attitude and velocity");
  }
  return {start->time_ns, start->position_world_m, start->velocity_world_mps, start->q_body_to_world};
}

void check_start(const recording::SensorLog& log, const RunOptions& options) {
  if (!options.start) return;
  if (options.start->sequence > log.events.size()) {
    throw std::invalid_argument("the saved state follows event " + std::to_string(options.start->sequence) +
                                ", but the recording has only " + std::to_string(log.events.size()) +
                                " events: it comes from another recording");
  }
  if (options.strapdown || estimation::kind_of(options.start->snapshot) != options.settings.engine.engine) {
    throw std::invalid_argument("the saved state comes from another kind of estimator");
  }
}

/// Passes the recording's events within the start and end of the options to `process`, which returns an
/// estimation::EventResult.
void run_through(const recording::SensorLog& log, const RunOptions& options, Results& results,
                 const auto& process) {
  RunResult& result = results.result();
  const TimeNs begin_ns = available_at_ns(log.events.front());
  std::uint64_t last_sequence = options.start ? options.start->sequence : 0;
  std::uint64_t last_digest = options.start ? options.start->last_event : 0;
  const Event* last = nullptr;
  const std::uint64_t skipped = last_sequence;
  std::optional<TimeNs> first_ns;
  TimeNs last_ns = 0;
  const auto is_over = [&](const Event& event) {
    return options.until_s && seconds_between(begin_ns, available_at_ns(event)) > *options.until_s;
  };
  TimeNs last_imu_ns = 0;
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    const Event& event = log.events[i];
    // A single late event may only have a wrong stamp.
    if (is_over(event) && (i + 1 == log.events.size() || is_over(log.events[i + 1]))) break;
    const TimeNs now_ns = available_at_ns(event);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) results.add(*fix);
    if (sequence_of(event) <= skipped) continue;
    results.add(process(event));
    ++result.events;
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      if (imu->sensor_time_ns < last_imu_ns) ++result.imu_stamps_back;
      last_imu_ns = imu->sensor_time_ns;
    }
    last = &event;
    if (!first_ns) first_ns = now_ns;
    last_ns = std::max(last_ns, now_ns);
  }
  if (first_ns) result.duration_s = seconds_between(*first_ns, last_ns);
  if (last != nullptr) {
    last_sequence = sequence_of(*last);
    last_digest = digest_of(*last);
  }
  result.end.sequence = last_sequence;
  result.end.last_event = last_digest;
  result.end.beacon = address_of(log.events.front());
  result.end.first_event_ns = begin_ns;
}

/// Counts velocities and valid headings, to find those of which an engine has used none.
class Aiding {
public:
  void add(const Event& event) {
    const auto* const heading = std::get_if<PairHeading>(&event);
    const bool is_set = heading != nullptr && (heading->flags & heading_flag_set_pose) != 0U;
    if (heading != nullptr && heading->valid && !is_set) {
      ++headings_;
      if (std::isfinite(heading->heading_world_rad)) ++finite_headings_;
    }
    if (std::holds_alternative<TwistSample>(event)) ++twists_;
  }

  void judge(const settings::Settings& settings, RunResult& result) const {
    constexpr std::uint64_t min_count = 3;
    const EstimatorCounters& counted = result.counters;
    if (const auto problem = estimation::aiding::twist_problem(counted, settings)) {
      std::string text = fmt::format("{}: {}", problem->text, problem->remedy);
      if (problem->are_unused && !problem->is_by_setting) {
        result.unused_inputs.push_back({.is_heading = false, .text = std::move(text)});
      } else {
        result.remarks.push_back(std::move(text));
      }
    } else if (twists_ >= min_count &&
               counted.twists_used + counted.twists_rejected + counted.twists_unused == 0) {
      result.unused_inputs.push_back(
          {.is_heading = false,
           .text = fmt::format("velocities are not used: all {} are impossible, or not finite", twists_)});
    }
    if (headings_ < min_count || counted.headings > 1) return;
    result.unused_inputs.push_back(
        {.is_heading = true,
         .text = fmt::format("headings are not used: all {} are {}", headings_,
                             finite_headings_ == 0 ? "not finite"
                                                   : "newer than the IMU samples or too old: compare their "
                                                     "stamps with those of the IMU")});
  }

private:
  std::uint64_t headings_ = 0;
  std::uint64_t finite_headings_ = 0;
  std::uint64_t twists_ = 0;
};

void run_engine(const recording::SensorLog& log, const RunOptions& options, Results& results) {
  estimation::AnyEstimator estimator(options.settings);
  if (options.start) estimator.restore(options.start->snapshot);
  estimation::SensorFaultDetector faults(estimator.settings());
  estimation::aiding::HeightCheck heights;
  Aiding aiding;
  const EstimatorCounters before = estimator.counters();
  run_through(log, options, results, [&](const Event& event) {
    results.predict(event, estimator);
    faults.on(event);
    aiding.add(event);
    estimation::aiding::RefusedFixes& refusals = results.result().refusals;
    if (const auto* imu = std::get_if<ImuSample>(&event)) refusals.on(*imu, estimator.settings().admission);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      heights.on(estimator.settings().planar, *fix);
      refusals.on(*fix, estimator.settings().admission);
    }
    auto output = estimation::process(estimator, event);
    if (auto* pose = std::get_if<FusedPose>(&output)) {
      faults.on(*pose);
      pose->status |= faults.status(pose->time_ns);
    }
    estimator.finish_pending_work();  // as in the live fusion
    return output;
  });
  results.result().end.snapshot = estimator.snapshot();
  results.digest().add(results.result().end.snapshot);
  if (const auto problem = heights.problem()) {
    results.result().remarks.push_back(problem->text + ": " + problem->remedy);
  }
  results.result().counters = estimator.counters() - before;
  aiding.judge(estimator.settings(), results.result());
}

void run_strapdown(const recording::SensorLog& log, const RunOptions& options, Results& results) {
  strapdown::Integrator integrator(options.settings, strapdown_start(log), *options.strapdown);
  run_through(log, options, results, [&](const Event& event) -> estimation::EventResult {
    results.predict(event);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      FixReport report = report_on(*fix, integrator.state().time_ns);
      report.shifted_position_world_m = fix->position_world_m;
      return report;
    }
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      if (const auto pose = integrator.predict(*imu)) return *pose;
    }
    return {};
  });
  results.result().counters = integrator.counters();
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
  const auto is_imu = [](const Event& event) { return std::holds_alternative<ImuSample>(event); };
  if (std::none_of(log.events.begin(), log.events.end(), is_imu)) {
    throw std::invalid_argument("the recording has no IMU sample: there is nothing to fuse");
  }
  check_start(log, options);
  Results results(log, options, observer);
  if (options.strapdown) {
    run_strapdown(log, options, results);
  } else {
    run_engine(log, options, results);
  }
  return results.finished();
}

}  // namespace sonopose::evaluation
