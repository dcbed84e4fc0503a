#pragma once
/// \file
/// The lines of the bridges.

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::observation::bus {

/// The lines that deliver no frames.
class LineObserver {
public:
  LineObserver(const dds::DomainParticipant& participant, const dds::qos::Provider& qos)
      : reader_(dds::topics::make_reader(participant, qos, dds::topics::line_status)) {}

  /// One of each line that delivers no frames.
  std::vector<std::string> warnings() {
    reader_.try_take_each(
        [this](const sonopose_LineStatus& sample, const dds::SampleInfo& info) {
          if (!info.alive()) {
            lines_.erase({sample.name, sample.bridge_id});
            return;
          }
          LineStatus line = dds::topics::from_idl(sample);
          const std::pair key{line.name, line.bridge_id};
          if (lines_.size() < most_lines || lines_.contains(key)) lines_[key] = std::move(line);
        },
        [this](const sonopose_LineStatus& key, const dds::SampleInfo& info) {
          if (!info.alive()) lines_.erase({key.name, key.bridge_id});
        });
    std::vector<std::string> texts;
    for (const auto& [key, line] : lines_) {
      if (!line.text.empty()) texts.push_back(fmt::format("line {}: {}", line.name, line.text));
    }
    return texts;
  }

private:
  static constexpr std::size_t most_lines = 256;

  dds::DataReader<sonopose_LineStatus> reader_;
  std::map<std::pair<std::string, std::uint64_t>, LineStatus> lines_;  ///< by name and bridge
};

}  // namespace sonopose::observation::bus
