#pragma once
/// \file
/// Topics on the bus that a recorder of native topics does not know.

#include <sonopose/dds/psm/discovery.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace sonopose::recorder {

class ForeignTopics {
public:
  /// Most topics to name: a bus can have any number, and the end of a file has little space.
  static constexpr std::size_t max_named = 200;

  /// Takes all writers. Returns lines about the new topics: those of ROS 2 share one if `records_ros2` is
  /// false, since they are known to be left out then.
  std::vector<std::string> update(const std::vector<dds::FoundEndpoint>& writers, bool records_ros2);

  /// Largest number of writers of each topic.
  [[nodiscard]] const std::map<std::string, std::size_t>& writer_counts() const { return writer_counts_; }

  /// Largest number of unnamed topics at a time.
  [[nodiscard]] std::size_t unnamed() const { return unnamed_; }

private:
  std::map<std::string, std::size_t> writer_counts_;
  std::size_t unnamed_ = 0;
};

}  // namespace sonopose::recorder
