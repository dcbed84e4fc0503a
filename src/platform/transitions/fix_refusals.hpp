#pragma once
/// \file
/// Detects that all fixes of a beacon are refused, and the reason.

#include <sonopose/samples/fix_refusal.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace sonopose::transitions {

/// Refusals of one beacon. A fix is refused if it is too old, from the future, out of order, out of range or
/// of low quality. Outliers are judged, not refused. Call `update` about once a second.
class FixRefusals {
public:
  static constexpr TimeNs timeout_ns = 1'000'000'000;

  /// Takes a report of the engine. Does not allocate.
  void on(const FixReport& report) noexcept;

  /// A message for the user: once when all fixes have been refused for `timeout_ns`, with the most frequent
  /// cause, and once when one is accepted again.
  std::optional<std::string> update(SteadyTime now);

  /// The most frequent cause of the refusals since the last accepted fix; empty without one.
  [[nodiscard]] std::string reason() const;

private:
  [[nodiscard]] std::uint64_t count() const;

  /// Fixes refused for one cause since the last accepted fix.
  struct Refused {
    std::uint64_t fixes = 0;
    double age_s = 0;  ///< age of the latest one
  };
  std::array<Refused, fix_refusal_count> refused_;  ///< by cause
  std::optional<SteadyTime> since_;
  bool reported_ = false;
};

}  // namespace sonopose::transitions
