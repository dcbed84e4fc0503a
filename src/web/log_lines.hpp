#pragma once
/// \file
/// The log lines of the processes on the bus, and the changes of state that none of them logs.

#include "process/instance_limit.hpp"
#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::web {

/// Reads the lines. One thread.
class LogLines {
public:
  LogLines(const dds::DomainParticipant& participant, const dds::qos::Provider& qos)
      : reader_(dds::topics::make_reader(participant, qos, dds::topics::log, nullptr,
                                         dds::topics::Delivery::live, &limit_)) {}

  /// Those that have arrived since the last call, by their time.
  std::vector<LogLine> take() {
    std::vector<LogLine> lines;
    reader_.try_take_each(
        [&](const sonopose_LogLine& sample, const dds::SampleInfo& info) {
          lines.push_back(dds::topics::from_idl(sample));
          programs_[key_of(sample)] = lines.back().program;
          if (!info.alive()) forget(sample);
        },
        [&](const sonopose_LogLine& key, const dds::SampleInfo& info) {
          if (!info.alive()) forget(key);
        });
    std::stable_sort(lines.begin(), lines.end(),
                     [](const LogLine& a, const LogLine& b) { return a.time_ns < b.time_ns; });
    return lines;
  }

  /// Whether a process of this name has logged and still runs.
  [[nodiscard]] bool has(const std::string& program) const {
    return std::any_of(programs_.begin(), programs_.end(),
                       [&](const auto& entry) { return entry.second == program; });
  }

  /// A message for the user, if processes were refused.
  std::optional<std::string> refusals() { return limit_.refusals(); }

private:
  using Key = std::pair<std::string, std::uint32_t>;

  static Key key_of(const sonopose_LogLine& sample) { return {sample.host, sample.process_id}; }

  void forget(const sonopose_LogLine& key) {
    programs_.erase(key_of(key));
    limit_.forget(key);
  }

  process::InstanceLimit<sonopose_LogLine> limit_;
  dds::DataReader<sonopose_LogLine> reader_;
  std::map<Key, std::string> programs_;
};

/// Texts that wait for two calls of `take_due`: a fusion that logs the same changes may be heard only then.
class HeldEvents {
public:
  static constexpr std::size_t most = 200;  ///< of which the latest are kept

  void hold(std::string text) {
    if (new_.size() == most) new_.erase(new_.begin());
    new_.push_back(std::move(text));
  }

  /// Those that were held at the call before. Once a second.
  std::vector<std::string> take_due() { return std::exchange(due_, std::exchange(new_, {})); }

  void clear() {
    new_.clear();
    due_.clear();
  }

private:
  std::vector<std::string> new_;
  std::vector<std::string> due_;
};

}  // namespace sonopose::web
