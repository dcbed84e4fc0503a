#pragma once
/// \file
/// Log lines of the processes on the bus.

#include "presence/instance_limit.hpp"
#include "web/live/missing_lines.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::web {

/// Reads log lines. Use it from one thread.
class LogLines {
public:
  struct Received {
    LogLine line;
    std::uint64_t missing = 0;  ///< missing lines of its process before this one
  };

  LogLines(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos)
      : reader_(dds::topics::make_reader(participant, qos, dds::topics::log, nullptr,
                                         dds::topics::Delivery::live, &limit_)) {}

  /// Returns the lines since the last call, ordered by time.
  std::vector<Received> take() {
    std::vector<Received> received;
    std::set<std::pair<std::string, std::uint32_t>> ended;  // not only the last line of a process says so
    const auto note_end = [&](const sonopose_LogLine& sample, const dds::sub::SampleInfo& info) {
      if (dds::ext::is_alive(info)) return;
      ended.emplace(sample.host, sample.process_id);
      limit_.forget(sample);
    };
    dds::ext::try_take_each(
        reader_,
        [&](const sonopose_LogLine& sample, const dds::sub::SampleInfo& info) {
          LogLine line = dds::topics::from_idl(sample);
          const std::uint64_t missing = missing_.before(line);
          received.push_back({std::move(line), missing});
          note_end(sample, info);
        },
        note_end);
    for (const auto& [host, process_id] : ended) missing_.forget(host, process_id);
    std::stable_sort(received.begin(), received.end(),
                     [](const Received& a, const Received& b) { return a.line.time_ns < b.line.time_ns; });
    return received;
  }

  /// A message for the user, if processes were refused.
  std::optional<std::string> refusals() { return limit_.refusals(); }

private:
  presence::InstanceLimit<sonopose_LogLine> limit_;
  dds::sub::DataReader<sonopose_LogLine> reader_;
  live::MissingLines missing_;
};

}  // namespace sonopose::web
