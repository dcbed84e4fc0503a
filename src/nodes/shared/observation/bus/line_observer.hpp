#pragma once
/// \file
/// Observes the lines of the bridges.

#include "presence/instance_limit.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::observation::bus {

/// Last status of each line whose bridge runs.
class LineObserver {
public:
  LineObserver(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos)
      : reader_(dds::topics::make_reader(participant, qos, dds::topics::line_status, nullptr,
                                         dds::topics::Delivery::live, &limit_)) {}

  /// Takes new statuses.
  void take() {
    dds::ext::try_take_each(
        reader_,
        [this](const sonopose_LineStatus& sample, const dds::sub::SampleInfo& info) {
          if (!dds::ext::is_alive(info)) {
            forget(sample);
            return;
          }
          LineStatus line = dds::topics::from_idl(sample);
          const std::pair key{line.name, line.bridge_id};
          lines_[key] = std::move(line);
        },
        [this](const sonopose_LineStatus& key, const dds::sub::SampleInfo& info) {
          if (!dds::ext::is_alive(info)) forget(key);
        });
  }

  /// Lines by name and bridge.
  [[nodiscard]] const std::map<std::pair<std::string, std::uint64_t>, LineStatus>& lines() const {
    return lines_;
  }

  /// Returns a warning for each line that delivers no frames.
  [[nodiscard]] std::vector<std::string> warnings() const {
    std::vector<std::string> texts;
    for (const auto& [key, line] : lines_) {
      if (!line.text.empty())
        texts.push_back(text::escaped(fmt::format("line {}: {}", line.name, line.text)));
    }
    return texts;
  }

  /// A message for the user, if lines were refused.
  std::optional<std::string> refusals() { return limit_.refusals(); }
  /// Final message with the number of lines that were not observed; empty if there were none.
  std::optional<std::string> warning() { return limit_.warning(); }

private:
  void forget(const sonopose_LineStatus& key) {
    lines_.erase({key.name, key.bridge_id});
    limit_.forget(key);
  }

  presence::InstanceLimit<sonopose_LineStatus> limit_;
  dds::sub::DataReader<sonopose_LineStatus> reader_;
  std::map<std::pair<std::string, std::uint64_t>, LineStatus> lines_;
};

}  // namespace sonopose::observation::bus
