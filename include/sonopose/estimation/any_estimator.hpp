#pragma once
/// \file
/// The estimator selected at run time. It satisfies Estimator itself.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <variant>

namespace sonopose::estimation {

/// Snapshot of an estimator of any kind; the alternatives are in the order of settings::EngineKind.
using AnySnapshot = std::variant<documented::Snapshot, kalman::Snapshot>;

class AnyEstimator {
public:
  using Snapshot = AnySnapshot;

  /// The estimator that fusion.engine selects.
  explicit AnyEstimator(const settings::Settings& settings);

  /// Begins with known errors of the sensors. Call it before the first event; a reset forgets them. The
  /// documented engine, which measures the gyroscope's offset at its start, ignores them.
  void start_from(const aiding::KnownSensors& known) noexcept;

  std::optional<FusedPose> predict(const ImuSample& imu) noexcept;
  FixReport correct(const UltrasonicFix& fix) noexcept;
  void correct(const PairHeading& heading) noexcept;
  void correct(const TwistSample& twist) noexcept;
  void finish_pending_work() noexcept;
  /// Applies new settings. A changed fusion.engine restarts with that engine, which allocates its memory.
  void configure(const settings::Settings& settings) noexcept;
  void reset() noexcept;

  /// Continues from a snapshot as an estimator of its kind, with the current settings.
  void restore(const Snapshot& snapshot) noexcept;
  [[nodiscard]] Snapshot snapshot() const;

  [[nodiscard]] settings::EngineKind kind() const {
    return static_cast<settings::EngineKind>(estimator_.index());
  }
  [[nodiscard]] const settings::Settings& settings() const;
  [[nodiscard]] const EstimatorCounters& counters() const;
  [[nodiscard]] std::uint32_t reset_counter() const;
  [[nodiscard]] TimeNs time_ns() const;
  [[nodiscard]] Estimate estimate() const;

private:
  std::variant<documented::Engine, kalman::Engine> estimator_;  // in the order of settings::EngineKind
};

static_assert(std::is_same_v<
              std::variant_alternative_t<static_cast<std::size_t>(settings::EngineKind::kalman), AnySnapshot>,
              kalman::Snapshot>);
static_assert(Estimator<documented::Engine>);
static_assert(Estimator<kalman::Engine>);
static_assert(Estimator<AnyEstimator>);

}  // namespace sonopose::estimation
