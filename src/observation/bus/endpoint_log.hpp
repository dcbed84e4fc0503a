#pragma once
/// \file
/// What goes wrong with this process's own readers, in the log.

#include "logging/log.hpp"
#include "process/endpoint_counters.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace sonopose::observation::bus {

/// Logs increases of the counters of this program's own readers.
class EndpointLog {
public:
  void log(const process::EndpointCounters& endpoints) {
    log_increase(endpoints.incompatible_qos, incompatible_reported_,
                 "writers offer incompatible QoS; run sonopose-doctor for details");
    log_increase(endpoints.samples_lost, lost_reported_, "samples were lost on the way to this program");
    log_increase(endpoints.samples_rejected, rejected_reported_,
                 "samples were rejected because a queue was full");
  }

private:
  static void log_increase(std::uint64_t count, std::uint64_t& reported, const char* what) {
    if (count != reported) logging::warning(fmt::format("{} {}", count - reported, what));
    reported = count;
  }

  std::uint64_t incompatible_reported_ = 0;
  std::uint64_t lost_reported_ = 0;
  std::uint64_t rejected_reported_ = 0;
};

}  // namespace sonopose::observation::bus
