#pragma once
/// \file
/// Finds the fusions that lose events of a recording that is played as fast as its readers accept.

#include "process/stop_signal.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sonopose::publication {

/// Receivers of this process's IMU samples that write poses and do not keep all samples: fusions without
/// --lossless.
class LossyFusions {
public:
  /// `qos` must outlive it.
  LossyFusions(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos);

  /// Logs each of them once. Call it after the readers have appeared, and before the first sample.
  void warn(const process::StopSignal& stop);

  /// Logs and returns the number of events that they have lost since warn(). Call it once the readers have
  /// received everything. Waits for their statuses, for up to 3 s.
  std::uint64_t count_lost(const process::StopSignal& stop);

private:
  /// Lost events of one beacon.
  struct Losses {
    std::uint64_t before = 0;
    std::uint64_t latest = 0;
    SteadyTime taken;  ///< time of the latest status
  };
  struct Fusion {
    std::string name;
    std::optional<dds::core::InstanceHandle> status_writer;
    std::map<std::uint64_t, Losses> beacons;  ///< by the instance of the status

    [[nodiscard]] bool has_status_since(SteadyTime begin) const;
    [[nodiscard]] std::uint64_t lost() const;
  };

  bool find();
  void take(bool has_begun);
  void wait_for_statuses(SteadyTime since, TimeNs max_ns, bool has_begun, const process::StopSignal& stop);

  dds::domain::DomainParticipant participant_;
  const dds::qos::Provider& qos_;
  dds::Discovery discovery_;
  std::optional<dds::sub::DataReader<sonopose_FusionStatus>> statuses_;  ///< empty while there are none
  std::map<std::string, Fusion> fusions_;                                ///< by participant
};

}  // namespace sonopose::publication
