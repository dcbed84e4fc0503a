#pragma once
/// \file
/// Logs problems of this process's own readers.

#include "clocks/clocks.hpp"
#include "logging/increase_log.hpp"
#include "logging/log.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/text/count_text.hpp>

namespace sonopose::observation::bus {

/// Logs increases of the counters of this program's own readers.
class EndpointLog {
public:
  /// Logs increases since the last call. Call it about once a second.
  void log(const process::EndpointCounters& endpoints) {
    const SteadyTime now = clocks::steady_now();
    using text::count_text;
    if (const auto more = incompatible_.update(endpoints.incompatible_qos, now)) {
      logging::warning(count_text(*more, "writer offers", "writers offer") +
                       " incompatible QoS; run sonopose-doctor for details");
    }
    if (const auto more = lost_.update(endpoints.samples_lost, now)) {
      logging::warning(count_text(*more, "sample was", "samples were") + " lost on the way to this program");
    }
    if (const auto more = rejected_.update(endpoints.samples_rejected, now)) {
      logging::warning(count_text(*more, "sample was", "samples were") +
                       " rejected because a queue was full");
    }
  }

private:
  logging::IncreaseLog incompatible_;
  logging::IncreaseLog lost_;
  logging::IncreaseLog rejected_;
};

}  // namespace sonopose::observation::bus
