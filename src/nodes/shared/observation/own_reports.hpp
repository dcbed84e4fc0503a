#pragma once
/// \file
/// Recognises the reports of the fusion whose poses consumers receive, among those of its standbys.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sonopose::observation {

/// Compares the processes of poses and reports. DDS selects the owner of the poses; each fusion reports on
/// each fix. Not thread-safe.
class OwnReports {
public:
  /// True if the participant `reporter` owns the poses of the beacon. Also if the owner is not known (empty),
  /// or has not reported yet: a source of poses need not report.
  bool accepts(BeaconAddress address, const std::string& reporter, const std::string& owner);

  /// Judges a report by its writer and that of the beacon's latest pose. Not for receive threads.
  bool accepts(BeaconAddress address, const dds::sub::DataReader<sonopose_FixReport>& reports,
               dds::core::InstanceHandle writer, const dds::sub::DataReader<sonopose_FusedPose>& poses,
               std::optional<dds::core::InstanceHandle> pose_writer);

private:
  using Participants = std::map<std::uint64_t, std::string>;

  struct Owner {
    std::string participant;
    bool has_reported = false;
  };

  std::map<BeaconAddress, Owner> owners_;
  Participants reporters_;     ///< by the handle of the writer
  Participants pose_writers_;  ///< by the handle of the writer
};

}  // namespace sonopose::observation
