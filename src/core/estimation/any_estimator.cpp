#include <sonopose/estimation/aiding/delay.hpp>
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
  const UltrasonicFix arrived = aiding::at_arrival(fix, time_ns());
  FixReport report = std::visit([&](auto& estimator) { return estimator.correct(arrived); }, estimator_);
  report.emission_time_ns = fix.emission_time_ns;  // by which readers find the fix
  return report;
}

void AnyEstimator::correct(const PairHeading& heading) noexcept {
  const PairHeading arrived = aiding::at_arrival(heading, time_ns());
  std::visit([&](auto& estimator) { estimator.correct(arrived); }, estimator_);
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
