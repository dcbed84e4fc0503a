#pragma once
/// \file
/// The estimator selected at run time. It satisfies Estimator itself.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/estimation/strapdown/engine.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

namespace sonopose::estimation {

enum class EstimatorKind : std::uint8_t {
  documented,  ///< fuses IMU, fixes and headings as the settings document describes
  strapdown,   ///< integrates the IMU alone from a known state
  kalman       ///< fuses the same sensors in an error-state Kalman filter
};

constexpr std::array<std::string_view, 3> choices_of(EstimatorKind /*kind*/) {
  return {"documented", "strapdown", "kalman"};
}

/// Snapshot of an estimator of any kind; the alternatives are in the order of EstimatorKind.
using AnySnapshot = std::variant<documented::Snapshot, strapdown::Snapshot, kalman::Snapshot>;

[[nodiscard]] constexpr EstimatorKind kind_of(settings::EngineKind engine) {
  return engine == settings::EngineKind::kalman ? EstimatorKind::kalman : EstimatorKind::documented;
}

/// Kind of an estimator, and what the strapdown estimator needs besides the settings.
struct EstimatorOptions {
  std::optional<EstimatorKind> kind{};  ///< empty: as set by fusion.engine
  strapdown::State strapdown_start{};
  strapdown::Rule strapdown_rule = strapdown::Rule::previous;
};

class AnyEstimator {
public:
  using Snapshot = AnySnapshot;

  explicit AnyEstimator(const settings::Settings& settings, const EstimatorOptions& options = {});

  std::optional<FusedPose> predict(const ImuSample& imu) noexcept;
  FixReport correct(const UltrasonicFix& fix) noexcept;
  void correct(const PairHeading& heading) noexcept;
  void finish_pending_work() noexcept;
  /// Applies new settings. A changed fusion.engine restarts with that engine, which allocates its memory.
  void configure(const settings::Settings& settings) noexcept;
  void reset() noexcept;

  /// Continues from a snapshot as an estimator of its kind, with the current settings.
  void restore(const Snapshot& snapshot) noexcept;
  [[nodiscard]] Snapshot snapshot() const;

  [[nodiscard]] EstimatorKind kind() const { return static_cast<EstimatorKind>(estimator_.index()); }
  [[nodiscard]] const settings::Settings& settings() const;
  [[nodiscard]] const EstimatorCounters& counters() const;
  [[nodiscard]] std::uint32_t reset_counter() const;
  [[nodiscard]] TimeNs time_ns() const;
  [[nodiscard]] Estimate estimate() const;

private:
  std::variant<documented::Engine, strapdown::Engine, kalman::Engine>
      estimator_;  // in the order of EstimatorKind
};

static_assert(Estimator<documented::Engine>);
static_assert(Estimator<strapdown::Engine>);
static_assert(Estimator<kalman::Engine>);
static_assert(Estimator<AnyEstimator>);

}  // namespace sonopose::estimation
