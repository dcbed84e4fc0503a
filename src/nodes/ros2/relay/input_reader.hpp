#pragma once
/// \file
/// The DDS reader of an input topic.

#include "process/endpoint_counters.hpp"
#include "ros2/inputs/input_monitor.hpp"
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <atomic>
#include <string>

namespace sonopose::ros2::relay {

/// Number of messages that a reader's full queue lost. Thread-safe.
inline std::uint64_t samples_lost(const process::EndpointCounters& counters) noexcept {
  return counters.samples_lost.load(std::memory_order_relaxed) +
         counters.samples_rejected.load(std::memory_order_relaxed);
}

/// Reads one topic with the profile ros2::Input.
template <class T>
struct InputReader {
  /// Statuses for the listener. The wait set handles data availability, and matches are polled.
  static constexpr dds::StatusMask counted_statuses = dds::StatusMask::requested_incompatible_qos() |
                                                      dds::StatusMask::sample_lost() |
                                                      dds::StatusMask::sample_rejected();

  /// `counters` must outlive it. Throws dds::Error.
  InputReader(ros2::Node& node, const std::string& topic, process::EndpointCounters& counters)
      : listener(counters),
        reader(node.make_reader<T>(topic, "ros2::Input", &listener, counted_statuses)),
        has_data(reader) {}

  process::CountingReaderListener<T> listener;
  dds::DataReader<T> reader;
  dds::ReadCondition has_data;
};

}  // namespace sonopose::ros2::relay
