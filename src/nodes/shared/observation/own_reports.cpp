#include "observation/own_reports.hpp"

#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>

namespace sonopose::observation {
namespace {

/// The participant of a matched writer; empty if the writer is gone.
std::string participant_of(const auto& reader, dds::core::InstanceHandle writer,
                           std::map<std::uint64_t, std::string>& known) {
  constexpr std::size_t max_known = 1024;  // writers that have ended stay
  if (const auto found = known.find(writer.c_value()); found != known.end()) return found->second;
  if (known.size() >= max_known) known.clear();
  const auto data = dds::ext::matched_publication_data(reader, writer);
  return data ? known[writer.c_value()] = dds::ext::text_of(data->participant_key) : "";
}

}  // namespace

bool OwnReports::accepts(BeaconAddress address, const std::string& reporter, const std::string& owner) {
  if (reporter.empty() || owner.empty()) return true;
  Owner& known = owners_[address];
  if (known.participant != owner) known = {owner, false};
  if (reporter == owner) known.has_reported = true;
  return reporter == owner || !known.has_reported;
}

bool OwnReports::accepts(BeaconAddress address, const dds::sub::DataReader<sonopose_FixReport>& reports,
                         dds::core::InstanceHandle writer,
                         const dds::sub::DataReader<sonopose_FusedPose>& poses,
                         std::optional<dds::core::InstanceHandle> pose_writer) {
  if (!pose_writer) return true;
  return accepts(address, participant_of(reports, writer, reporters_),
                 participant_of(poses, *pose_writer, pose_writers_));
}

}  // namespace sonopose::observation
