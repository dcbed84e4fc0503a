#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/snapshot_fields.hpp>

#include <type_traits>

namespace sonopose::estimation {
namespace {

std::variant<documented::Engine, kalman::Engine> make(settings::EngineKind kind,
                                                      const settings::Settings& settings) {
  if (kind == settings::EngineKind::kalman) return kalman::Engine(settings);
  return documented::Engine(settings);
}

/// A pose that the user sets holds when it arrives: its stamps are of another clock than the IMU's, whose
/// samples may also arrive late.
template <class Sample>
Sample at_arrival(Sample set, TimeNs now_ns) {
  constexpr TimeNs heading_earlier_ns = 1'000'000;  // the heading precedes its fix
  if (now_ns == 0) return set;                      // nothing has arrived
  set.emission_time_ns = set.received_time_ns = now_ns;
  if constexpr (std::is_same_v<Sample, PairHeading>) {
    set.emission_time_ns = set.received_time_ns = now_ns - heading_earlier_ns;
  } else {
    set.measured_delay_s = 0;
  }
  return set;
}

}  // namespace

AnyEstimator::AnyEstimator(const settings::Settings& settings)
    : estimator_(make(settings.engine.engine, settings)) {}

void AnyEstimator::start_from(const aiding::KnownSensors& known) noexcept {
  if (auto* const engine = std::get_if<kalman::Engine>(&estimator_)) engine->start_from(known);
}

std::optional<FusedPose> AnyEstimator::predict(const ImuSample& imu) noexcept {
  auto pose = std::visit([&](auto& estimator) { return estimator.predict(imu); }, estimator_);
  if (pose) aiding::flatten(settings().planar, *pose);
  return pose;
}

FixReport AnyEstimator::correct(const UltrasonicFix& fix) noexcept {
  if ((fix.flags & ultrasonic_flag_set_pose) != 0) {
    const UltrasonicFix set = at_arrival(fix, time_ns());
    return std::visit([&](auto& estimator) { return estimator.correct(set); }, estimator_);
  }
  return std::visit([&](auto& estimator) { return estimator.correct(fix); }, estimator_);
}

void AnyEstimator::correct(const PairHeading& heading) noexcept {
  if ((heading.flags & heading_flag_set_pose) != 0) {
    const PairHeading set = at_arrival(heading, time_ns());
    std::visit([&](auto& estimator) { estimator.correct(set); }, estimator_);
    return;
  }
  std::visit([&](auto& estimator) { estimator.correct(heading); }, estimator_);
}

void AnyEstimator::correct(const TwistSample& twist) noexcept {
  std::visit([&](auto& estimator) { estimator.correct(twist); }, estimator_);
}

void AnyEstimator::finish_pending_work() noexcept {
  std::visit([](auto& estimator) { estimator.finish_pending_work(); }, estimator_);
}

void AnyEstimator::configure(const settings::Settings& settings) noexcept {
  if (settings.engine.engine != this->settings().engine.engine) {
    Snapshot fresh = initial_snapshot(settings.engine.engine);
    counters_of(fresh) = counters();
    reset_counter_of(fresh) = reset_counter() + 1;
    restore(fresh);
  }
  std::visit([&](auto& estimator) { estimator.configure(settings); }, estimator_);
}

void AnyEstimator::reset() noexcept {
  std::visit([](auto& estimator) { estimator.reset(); }, estimator_);
}

void AnyEstimator::restore(const Snapshot& snapshot) noexcept {
  if (snapshot.index() != estimator_.index()) {
    estimator_ = make(kind_of(snapshot), settings::Settings(settings()));
  }
  std::visit(
      [&](auto& estimator) {
        using Kind = typename std::remove_cvref_t<decltype(estimator)>::Snapshot;
        estimator.restore(*std::get_if<Kind>(&snapshot));
      },
      estimator_);
}

AnyEstimator::Snapshot AnyEstimator::snapshot() const {
  return std::visit([](const auto& estimator) { return Snapshot(estimator.snapshot()); }, estimator_);
}

const settings::Settings& AnyEstimator::settings() const {
  return std::visit(
      [](const auto& estimator) -> const auto& { return estimator.settings(); }, estimator_);
}

const EstimatorCounters& AnyEstimator::counters() const {
  return std::visit(
      [](const auto& estimator) -> const auto& { return estimator.counters(); }, estimator_);
}

std::uint32_t AnyEstimator::reset_counter() const {
  return std::visit([](const auto& estimator) { return estimator.reset_counter(); }, estimator_);
}

Estimate AnyEstimator::estimate() const {
  return std::visit([](const auto& estimator) { return estimator.estimate(); }, estimator_);
}

TimeNs AnyEstimator::time_ns() const {
  return std::visit([](const auto& estimator) { return estimator.time_ns(); }, estimator_);
}

}  // namespace sonopose::estimation
