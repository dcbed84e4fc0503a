#pragma once
/// \file
/// The DDS reader of an input topic.

#include "process/endpoint_counters.hpp"
#include "ros2/inputs/input_monitor.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <atomic>
#include <string>

namespace sonopose::ros2::relay {

/// Number of messages that a reader's full queue lost. Thread-safe.
inline std::uint64_t samples_lost(const process::EndpointCounters& counters) noexcept {
  return counters.samples_lost.load(std::memory_order_relaxed) +
         counters.samples_rejected.load(std::memory_order_relaxed);
}

/// Number of matched publishers.
template <class T>
std::uint64_t publishers_of(dds::sub::DataReader<T>& reader) {
  return static_cast<std::uint64_t>(reader.subscription_matched_status().current_count());
}

/// Reads one topic with the profile ros2::Input.
template <class T>
struct InputReader {
  /// Statuses for the listener. The wait set handles data availability, and matches are polled.
  static dds::core::status::StatusMask counted_statuses() {
    using Mask = dds::core::status::StatusMask;
    return Mask::requested_incompatible_qos() | Mask::sample_lost() | Mask::sample_rejected();
  }

  /// `counters` must outlive it. Throws dds::core::Exception.
  InputReader(ros2::Node& node, const std::string& topic, process::EndpointCounters& counters)
      : listener(counters),
        reader(node.make_reader<T>(topic, "ros2::Input", &listener, counted_statuses())),
        has_data(reader, dds::sub::status::DataState::any()) {}
  InputReader(const InputReader&) = delete;
  InputReader& operator=(const InputReader&) = delete;
  /// Ends the reader before its listener: a wait set may still have references to it.
  ~InputReader() { reader.close(); }

  process::CountingReaderListener<T> listener;
  dds::sub::DataReader<T> reader;
  dds::sub::cond::ReadCondition has_data;
};

}  // namespace sonopose::ros2::relay
