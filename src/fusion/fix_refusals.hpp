#pragma once
/// \file
/// Detects that all fixes of a beacon are refused, and why.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace sonopose::fusion {

/// A fix is refused if it is too old, from the future, out of order, out of range or of low quality. Outliers
/// are not refused, but judged. One beacon; updated about once a second.
class FixRefusals {
public:
  static constexpr TimeNs timeout_ns = 1'000'000'000;

  /// A report of the engine. Does not allocate.
  void on(const FixReport& report) noexcept;

  /// A message for the user: once when all fixes have been refused for `timeout_ns`, with the reason for the
  /// latest one, and once when one is not refused any more.
  std::optional<std::string> update(SteadyTime now);

private:
  [[nodiscard]] std::string reason() const;

  std::uint64_t refused_ = 0;  ///< since the last one that was not
  FixReport latest_;           ///< of them
  std::optional<SteadyTime> since_;
  bool reported_ = false;
};

}  // namespace sonopose::fusion
