#pragma once
/// \file
/// Counts the DDS statuses of a process's own readers and writers, on Cyclone's threads.

#include <sonopose/dds/psm/ext.hpp>

#include <atomic>
#include <cstdint>

namespace sonopose::process {

/// Counters that any number of endpoints can share.
struct EndpointCounters {
  std::atomic<std::uint64_t> offered_deadlines_missed = 0;
  std::atomic<std::uint64_t> liveliness_lost = 0;   ///< expired leases of writers
  std::atomic<std::uint64_t> incompatible_qos = 0;  ///< matches that failed because of QoS
  std::atomic<std::uint64_t> samples_lost = 0;
  std::atomic<std::uint64_t> samples_rejected = 0;
};

/// Adds the change that a DDS status reports.
inline void add(std::atomic<std::uint64_t>& counter, std::int32_t change) noexcept {
  if (change > 0) counter.fetch_add(static_cast<std::uint64_t>(change), std::memory_order_relaxed);
}

template <class T>
class CountingWriterListener final : public dds::pub::NoOpDataWriterListener<T> {
public:
  explicit CountingWriterListener(EndpointCounters& counters) : counters_(counters) {}

  void on_offered_deadline_missed(
      dds::pub::DataWriter<T>& /*writer*/,
      const dds::core::status::OfferedDeadlineMissedStatus& status) noexcept override {
    add(counters_.offered_deadlines_missed, status.total_count_change());
  }
  void on_offered_incompatible_qos(
      dds::pub::DataWriter<T>& /*writer*/,
      const dds::core::status::OfferedIncompatibleQosStatus& status) noexcept override {
    add(counters_.incompatible_qos, status.total_count_change());
  }
  void on_liveliness_lost(dds::pub::DataWriter<T>& /*writer*/,
                          const dds::core::status::LivelinessLostStatus& status) noexcept override {
    add(counters_.liveliness_lost, status.total_count_change());
  }

private:
  EndpointCounters& counters_;
};

/// Counts the statuses of a reader; base class of listeners that also take data.
template <class T>
class CountingReaderListener : public dds::sub::NoOpDataReaderListener<T> {
public:
  explicit CountingReaderListener(EndpointCounters& counters) : counters_(counters) {}

  void on_requested_incompatible_qos(
      dds::sub::DataReader<T>& /*reader*/,
      const dds::core::status::RequestedIncompatibleQosStatus& status) noexcept override {
    add(counters_.incompatible_qos, status.total_count_change());
  }
  void on_sample_lost(dds::sub::DataReader<T>& /*reader*/,
                      const dds::core::status::SampleLostStatus& status) noexcept override {
    add(counters_.samples_lost, status.total_count_change());
  }
  void on_sample_rejected(dds::sub::DataReader<T>& /*reader*/,
                          const dds::core::status::SampleRejectedStatus& status) noexcept override {
    add(counters_.samples_rejected, status.total_count_change());
  }

private:
  EndpointCounters& counters_;
};

}  // namespace sonopose::process
