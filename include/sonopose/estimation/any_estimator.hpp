#pragma once
/// \file
/// The estimator that is selected at run time. It satisfies Estimator itself.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/strapdown/engine.hpp>

#include <array>
#include <cstdint>
#include <string_view>
#include <variant>

namespace sonopose::estimation {

enum class EstimatorKind : std::uint8_t {
  documented,  ///< fuses IMU, fixes and headings as the settings document describes
  strapdown    ///< integrates the IMU alone from a known state
};

constexpr std::array<std::string_view, 2> choices_of(EstimatorKind /*kind*/) {
  return {"documented", "strapdown"};
}

/// The state of an estimator of either kind; the alternatives are in the order of EstimatorKind.
using AnySnapshot = std::variant<documented::Snapshot, strapdown::Snapshot>;

/// An estimator, and what the strapdown estimator needs besides the settings.
struct EstimatorOptions {
  EstimatorKind kind = EstimatorKind::documented;
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
  void configure(const settings::Settings& settings) noexcept;
  void reset() noexcept;

  /// Continues from a snapshot and becomes an estimator of its kind, with the present settings.
  void restore(const Snapshot& snapshot) noexcept;
  [[nodiscard]] Snapshot snapshot() const;

  [[nodiscard]] EstimatorKind kind() const { return static_cast<EstimatorKind>(estimator_.index()); }
  [[nodiscard]] const settings::Settings& settings() const;
  [[nodiscard]] const EstimatorCounters& counters() const;
  [[nodiscard]] std::uint32_t reset_counter() const;
  [[nodiscard]] TimeNs time_ns() const;
  [[nodiscard]] Estimate estimate() const;

private:
  std::variant<documented::Engine, strapdown::Engine> estimator_;  // in the order of EstimatorKind
};

static_assert(Estimator<documented::Engine>);
static_assert(Estimator<strapdown::Engine>);
static_assert(Estimator<AnyEstimator>);

}  // namespace sonopose::estimation
