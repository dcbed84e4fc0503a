#pragma once
/// \file
/// Metrics of all beacons for Prometheus, and whether the system is healthy and ready.

#include "observation/bus/bus_watch.hpp"
#include "threads/mutex.hpp"
#include "web/http/server.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::web {

/// Writes the observations of a second in the text format of Prometheus, version 0.0.4. Names end in the
/// unit; the label `beacon` is the address.
/// `expiries_s` are those of the certificates in the key store, by enclave.
std::string metrics_text(const std::vector<observation::BeaconView>& beacons, TimeNs now_ns,
                         const std::map<std::string, std::int64_t>& expiries_s = {});

/// Returns why poses are missing: no beacon, or beacons whose poses do not arrive. Empty if all have poses.
std::string why_not_ready(const std::vector<observation::BeaconView>& beacons);

/// Answers to /metrics, /healthz and /readyz. Thread-safe.
class Metrics {
public:
  explicit Metrics(std::map<std::string, std::int64_t> expiries_s = {})
      : expiries_s_(std::move(expiries_s)) {}

  /// Replaces the observations. Call it once a second.
  void update(const std::vector<observation::BeaconView>& beacons, TimeNs now_ns, SteadyTime now);

  /// Returns the answer; empty for another path. /healthz is 503 if `update` was not called for 5 s.
  [[nodiscard]] std::optional<http::Response> get(std::string_view path, SteadyTime now) const;

private:
  const std::map<std::string, std::int64_t> expiries_s_;
  mutable threads::Mutex mutex_;
  std::string text_ SONOPOSE_GUARDED_BY(mutex_);
  std::string why_not_ready_ SONOPOSE_GUARDED_BY(mutex_);
  SteadyTime updated_ SONOPOSE_GUARDED_BY(mutex_);
};

}  // namespace sonopose::web
