#include "doctor/probe/beacon_probe.hpp"

#include "doctor/probe/longest_rest.hpp"
#include "installation/sample_window.hpp"
#include "motion/fit/window_fit.hpp"
#include "motion/fix_faults.hpp"
#include "motion/imu_faults.hpp"
#include "motion/imu_summary.hpp"
#include "motion/turn_gain.hpp"
#include "observation/beacon_observer.hpp"
#include "observation/status_words.hpp"
#include "recording/velocity_check.hpp"
#include <sonopose/estimation/aiding/height_check.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sonopose::doctor::probe {
namespace {

/// Counts jumps of the position to fixes that were rejected before.
class Relocations {
public:
  explicit Relocations(rules::FixOutcomes& outcomes) : outcomes_(outcomes) {}

  /// Adds a report, in order of arrival.
  void add(TimeNs received_ns, std::uint32_t flags, const Vector3d& jump_world_m) {
    if ((flags & fix_frozen) != 0U) frozen_ns_ = received_ns;
    if ((flags & (fix_frozen | fix_too_late | fix_invalid | fix_low_quality)) != 0U) return;
    if ((flags & fix_stuck_forced) == 0U) return run_.reset();
    if (!run_) run_ = Run{.is_after_freeze = frozen_ns_ && received_ns - *frozen_ns_ < after_freeze_ns};
    run_->moved_world_m += jump_world_m;
    const double moved_m = run_->moved_world_m.norm();
    if (run_->is_after_freeze || moved_m <= relocated_m) return;
    if (!std::exchange(run_->is_counted, true)) ++outcomes_.relocations;
    outcomes_.longest_relocation_m = std::max(outcomes_.longest_relocation_m, moved_m);
  }

private:
  static constexpr double relocated_m = 0.3;  // as in the log
  /// Time after a freeze in which jumps are expected: the freeze itself is reported.
  static constexpr TimeNs after_freeze_ns = 10'000'000'000;

  /// Consecutive forced reports: the documented engine spreads one move over several fixes.
  struct Run {
    bool is_after_freeze = false;
    bool is_counted = false;
    Vector3d moved_world_m = Vector3d::Zero();
  };

  rules::FixOutcomes& outcomes_;
  std::optional<TimeNs> frozen_ns_;
  std::optional<Run> run_;
};

}  // namespace

void BeaconProbe::Stream::begin(TimeNs now_ns, double stream_deadline_s) {
  last_ns = now_ns;
  deadline_s = stream_deadline_s;
}

void BeaconProbe::Stream::count(const Arrival& arrival) {
  ++samples;
  add_silence(arrival.time_ns - last_ns - arrival.unwatched_ns);
  last_ns = arrival.time_ns;
}

void BeaconProbe::Stream::add_silence(TimeNs length_ns) {
  longest_ns = std::max(longest_ns, length_ns);
  if (static_cast<double>(length_ns) * 1e-9 <= deadline_s) return;
  ++silences;
  silent_ns += length_ns;
}

rules::StreamObservation BeaconProbe::Stream::observation(TimeNs began_ns, TimeNs ended_ns) const {
  const double window_s = seconds_between(began_ns, ended_ns);
  Stream ended = *this;
  ended.add_silence(ended_ns - last_ns);
  return {.samples = samples,
          .rate_hz = window_s > 0 ? static_cast<double>(samples) / window_s : 0.0,
          .longest_silence_s = seconds_between(0, ended.longest_ns),
          .deadline_s = deadline_s,
          .silences = ended.silences,
          .silent_s = seconds_between(0, ended.silent_ns)};
}

void BeaconProbe::begin(TimeNs now_ns, const Deadlines& deadlines) {
  began_ns_ = now_ns;
  imu_.begin(now_ns, deadlines.imu_s);
  fix_.begin(now_ns, deadlines.fix_s);
  heading_.begin(now_ns, deadlines.heading_s);
  pose_.begin(now_ns, deadlines.pose_s);
  pair_losses_.begin(now_ns);
}

void BeaconProbe::on(const ImuSample& imu, const Arrival& arrival, std::uint64_t writer) {
  if (imu.sequence < last_imu_sequence_) sequences_.clear();  // its bridge restarted
  last_imu_sequence_ = imu.sequence;
  sequences_.add(arrival.time_ns, imu.sequence);
  if (!in_window()) return;
  writers_.insert(writer);
  imu_.count(arrival);
  readings_.add(arrival.time_ns, imu);
  ahead_s_.add(arrival.time_ns, seconds_between(arrival.host_ns, imu.bridge_time_ns));
}

void BeaconProbe::on(const UltrasonicFix& fix, const Arrival& arrival) {
  if (fix.sequence != unnumbered) sequences_.add(arrival.time_ns, fix.sequence);
  if (!in_window()) return;
  fix_.count(arrival);
  pair_losses_.on_fix(arrival.time_ns);
  if (!tag_body_m_) tag_body_m_ = fix.point_body_m;
  if (fix.point_body_m == *tag_body_m_) fixes_.add(arrival.time_ns, fix);
  if (fix.measured_delay_s) ++timed_fixes_;
  min_fix_delay_s_ = std::min(min_fix_delay_s_.value_or(std::numeric_limits<double>::max()),
                              seconds_between(fix.emission_time_ns, fix.received_time_ns));
  if ((fix.flags & ultrasonic_flag_pair_centre) != 0U) ++pair_fixes_;
}

void BeaconProbe::on(const PairHeading& heading, const Arrival& arrival) {
  if (heading.sequence != unnumbered) sequences_.add(arrival.time_ns, heading.sequence);
  if (!in_window() || (heading.flags & heading_flag_set_pose) != 0U) return;
  heading_.count(arrival);
  if (heading.valid) headings_.add(arrival.time_ns, heading);
  if ((heading.flags & heading_flag_of_body) != 0U) return;
  ++pair_headings_;
  if (!heading.valid) return;
  ++valid_pair_headings_;
  pair_losses_.on_heading(arrival.time_ns);
}

void BeaconProbe::on(const TwistSample& twist, const Arrival& arrival) {
  if (twist.sequence != unnumbered) sequences_.add(arrival.time_ns, twist.sequence);
  if (in_window()) twists_.add(arrival.time_ns, twist);
}

void BeaconProbe::on(const FusedPose& pose, const Arrival& arrival) {
  if (!in_window()) return;
  pose_.count(arrival);
  status_counts_.add(observation::causes_in(pose.status));
}

void BeaconProbe::on(const FixReport& report, const Arrival& arrival) {
  if (!in_window()) return;
  outcomes_.add(arrival.time_ns,
                {report.flags, refusal_of(report), report.innovation_world_m, report.jump_world_m});
}

void BeaconProbe::on(const BeaconStatus& status) {
  if (!status_before_) status_before_ = status;
  status_ = status;
}

void BeaconProbe::on(const FusionStatus& status) {
  const auto [found, is_new] = fusions_.try_emplace(status.fusion_id, FusionObservation{{status, status}});
  found->second.span.latest = status;
  found->second.has_ended = false;
}

void BeaconProbe::end_fusion(std::uint64_t fusion_id) {
  const auto found = fusions_.find(fusion_id);
  if (found != fusions_.end()) found->second.has_ended = true;
}

void BeaconProbe::count_missing_events(TimeNs ended_ns, rules::BeaconObservation& beacon) const {
  // Samples of different topics arrive in any order. The last ones may still be in transit.
  constexpr TimeNs in_transit_ns = 200'000'000;
  // For the same reason, some of the oldest may belong to dropped numbers.
  TimeNs begin_ns = began_ns_;
  if (sequences_.has_dropped()) {
    begin_ns = std::max(begin_ns, sequences_.entries().front().received_ns + in_transit_ns);
  }
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::set<std::uint64_t> received;
  for (const auto& [received_ns, sequence] : sequences_.entries()) {
    received.insert(sequence);
    if (received_ns < begin_ns || received_ns > ended_ns - in_transit_ns) continue;
    if (first == 0 || sequence < first) first = sequence;
    last = std::max(last, sequence);
  }
  if (first == 0) return;
  const auto present = std::distance(received.lower_bound(first), received.upper_bound(last));
  beacon.events_expected = last - first + 1;
  beacon.events_missing = beacon.events_expected - static_cast<std::uint64_t>(present);
}

rules::FixOutcomes BeaconProbe::fix_outcomes() const {
  rules::FixOutcomes outcomes;
  Relocations relocations(outcomes);
  for (const auto& [received_ns, outcome] : outcomes_.entries()) {
    ++outcomes.reports;
    if (outcome.refusal) ++outcomes.refused.at(static_cast<std::size_t>(*outcome.refusal));
    if ((outcome.flags & fix_outlier) != 0U) outcomes.outliers_m.push_back(outcome.innovation_world_m);
    relocations.add(received_ns, outcome.flags, outcome.jump_world_m);
  }
  return outcomes;
}

/// The median over the kept samples.
std::optional<double> BeaconProbe::bridge_ahead_s() const {
  std::vector<double> ahead_s;
  for (const auto& entry : ahead_s_.entries()) ahead_s.push_back(entry.value);
  if (ahead_s.empty()) return std::nullopt;
  const auto middle = ahead_s.begin() + static_cast<std::ptrdiff_t>(ahead_s.size() / 2);
  std::nth_element(ahead_s.begin(), middle, ahead_s.end());
  return *middle;
}

/// True if a stronger fusion served the beacon when this one ended: consumers missed nothing of it.
bool BeaconProbe::stood_by(const rules::FusionSpan& ended) const {
  return std::any_of(fusions_.begin(), fusions_.end(), [&](const auto& entry) {
    const rules::FusionSpan& other = entry.second.span;
    return observation::serves_before(other.latest, ended.latest) &&
           other.before.time_ns <= ended.latest.time_ns && ended.latest.time_ns <= other.latest.time_ns;
  });
}

rules::BeaconObservation BeaconProbe::observation(TimeNs now_ns, const settings::Settings& settings) const {
  rules::BeaconObservation beacon;
  beacon.fusion_settings = settings;
  beacon.pair_fixes = pair_fixes_;
  beacon.fix_outcomes = fix_outcomes();
  estimation::aiding::HeightCheck heights;
  for (const auto& [received_ns, fix] : fixes_.entries()) heights.on(settings.planar, fix);
  beacon.height_problem = heights.problem();
  beacon.timed_fixes = timed_fixes_;
  beacon.min_fix_delay_s = min_fix_delay_s_.value_or(0.0);
  beacon.imu = imu_.observation(began_ns_, now_ns);
  beacon.fix = fix_.observation(began_ns_, now_ns);
  beacon.heading = heading_.observation(began_ns_, now_ns);
  beacon.pose = pose_.observation(began_ns_, now_ns);
  beacon.pair_headings = pair_headings_;
  beacon.valid_pair_headings = valid_pair_headings_;
  if (pair_headings_ > 0) beacon.pair_lost_s = pair_losses_.lost_s(now_ns);
  count_missing_events(now_ns, beacon);
  beacon.bridge_ahead_s = bridge_ahead_s();
  beacon.status_before = status_before_;
  beacon.status = status_;
  for (const auto& entry : fusions_) {
    const rules::FusionSpan& fusion = entry.second.span;
    if (entry.second.has_ended) {
      if (observation::serves(fusion.latest) && !stood_by(fusion)) beacon.ended_fusions.push_back(fusion);
      continue;
    }
    beacon.fusions.push_back(fusion.latest);
    if (beacon.fusion && !observation::serves_before(fusion.latest, *beacon.fusion)) continue;
    beacon.fusion_before = fusion.before;
    beacon.fusion = fusion.latest;
  }
  beacon.status_counts = status_counts_;
  motion::Window window = motion_window(settings);
  beacon.imu_summary = motion::summary_of(window.imu);
  beacon.turn_gain = motion::turn_gain_of(window);
  beacon.fix_faults = motion::fix_faults_of(window, beacon.turn_gain);
  recording::VelocityCheck velocities;
  for (const auto& [received_ns, twist] : twists_.entries()) velocities.add(twist);
  beacon.velocity_fault = velocities.unit(window.fixes, [](const char*) { return "Topics have m s^-1"; });
  window.imu = motion_window({}).imu;  // the sensor's own axes: a misalignment mixes them
  beacon.imu_faults = motion::imu_faults_of(window);
  beacon.rest = longest_rest(readings_, fixes_, settings.calibration);
  return beacon;
}

std::vector<motion::fit::Piece> BeaconProbe::pieces(const settings::Settings& settings,
                                                    const std::function<bool()>& is_stopped) const {
  motion::Window window = motion_window(settings);
  motion::remove_default_position(window.fixes);
  return motion::fit::pieces_of(std::move(window), {.is_stopped = is_stopped});
}

/// The samples for the fit.
motion::Window BeaconProbe::motion_window(const settings::Settings& settings) const {
  installation::SampleWindow samples(settings);
  for (const auto& [received_ns, imu] : readings_.entries()) samples.add(imu);
  for (const auto& [received_ns, fix] : fixes_.entries()) samples.add(fix);
  for (const auto& [received_ns, heading] : headings_.entries()) samples.add(heading);
  return std::move(samples).window();
}

settings::Settings settings_from(const EffectiveSettings& settings) {
  settings::Settings all;
  for (const auto& [key, value] : settings.values) {
    try {
      settings::set(all, key, settings::parse_value(key, value));
    } catch (const settings::SettingError&) {
      continue;  // a setting of another version
    }
  }
  return all;
}

}  // namespace sonopose::doctor::probe
