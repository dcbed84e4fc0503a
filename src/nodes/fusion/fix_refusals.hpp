#pragma once
/// \file
/// Detects that all fixes of a beacon are refused, and the reason.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace sonopose::fusion {

/// Refusals of one beacon. A fix is refused if it is too old, from the future, out of order, out of range or
/// of low quality. Outliers are judged, not refused. Call `update` about once a second.
class FixRefusals {
public:
  static constexpr TimeNs timeout_ns = 1'000'000'000;

  /// Takes a report of the engine. Does not allocate.
  void on(const FixReport& report) noexcept;

  /// A message for the user: once when all fixes have been refused for `timeout_ns`, with the reason for the
  /// latest one, and once when one is accepted again.
  std::optional<std::string> update(SteadyTime now);

private:
  [[nodiscard]] std::string reason() const;

  std::uint64_t refused_ = 0;  ///< refused since the last accepted fix
  FixReport latest_;           ///< latest refused fix
  std::optional<SteadyTime> since_;
  bool reported_ = false;
};

}  // namespace sonopose::fusion
