#pragma once
/// \file
/// What the middleware tells of a process's own readers and writers, counted on its threads.

#include <sonopose/dds/binding/listener.hpp>

#include <atomic>
#include <cstdint>

namespace sonopose::process {

/// Of all ends that share it.
struct EndpointCounters {
  std::atomic<std::uint64_t> offered_deadlines_missed = 0;
  std::atomic<std::uint64_t> liveliness_lost = 0;   ///< of a writer: its lease ran out
  std::atomic<std::uint64_t> incompatible_qos = 0;  ///< other ends that were refused, or refused
  std::atomic<std::uint64_t> samples_lost = 0;
  std::atomic<std::uint64_t> samples_rejected = 0;
};

/// Adds what a DDS status says has changed.
inline void add(std::atomic<std::uint64_t>& counter, std::int32_t change) noexcept {
  if (change > 0) counter.fetch_add(static_cast<std::uint64_t>(change), std::memory_order_relaxed);
}

/// Counts for a writer.
template <class T>
class CountingWriterListener final : public dds::DataWriterListener<T> {
public:
  explicit CountingWriterListener(EndpointCounters& counters) : counters_(counters) {}

  void on_offered_deadline_missed(dds::DataWriter<T>& /*writer*/,
                                  const dds::OfferedDeadlineMissedStatus& status) noexcept override {
    add(counters_.offered_deadlines_missed, status.total_count_change);
  }
  void on_offered_incompatible_qos(dds::DataWriter<T>& /*writer*/,
                                   const dds::OfferedIncompatibleQosStatus& status) noexcept override {
    add(counters_.incompatible_qos, status.total_count_change);
  }
  void on_liveliness_lost(dds::DataWriter<T>& /*writer*/,
                          const dds::LivelinessLostStatus& status) noexcept override {
    add(counters_.liveliness_lost, status.total_count_change);
  }

private:
  EndpointCounters& counters_;
};

/// Counts for a reader; base of listeners that take data too.
template <class T>
class CountingReaderListener : public dds::DataReaderListener<T> {
public:
  explicit CountingReaderListener(EndpointCounters& counters) : counters_(counters) {}

  void on_requested_incompatible_qos(dds::DataReader<T>& /*reader*/,
                                     const dds::RequestedIncompatibleQosStatus& status) noexcept override {
    add(counters_.incompatible_qos, status.total_count_change);
  }
  void on_sample_lost(dds::DataReader<T>& /*reader*/, const dds::SampleLostStatus& status) noexcept override {
    add(counters_.samples_lost, status.total_count_change);
  }
  void on_sample_rejected(dds::DataReader<T>& /*reader*/,
                          const dds::SampleRejectedStatus& status) noexcept override {
    add(counters_.samples_rejected, status.total_count_change);
  }

private:
  EndpointCounters& counters_;
};

}  // namespace sonopose::process
