#pragma once
/// \file
/// Samples that were read or taken, each with its SampleInfo. Left out: GenerationCount, Rank, SharedSamples,
/// and Sample, to which the official SampleRef converts.

#include "../core/Entity.hpp"
#include "../core/Time.hpp"
#include "status/DataState.hpp"

#include <dds/dds.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace dds::inline sonopose_psm::sub {

/// Metadata of a sample.
class SampleInfo {
public:
  SampleInfo() = default;
  explicit SampleInfo(const dds_sample_info_t& info) : info_(info) {}

  /// Time of writing, in the writer's clock or as the writer specified.
  const core::Time timestamp() const { return core::detail::to_time(info_.source_timestamp); }
  const status::DataState state() const {
    return status::DataState::of_c_mask(std::uint32_t{info_.sample_state} | std::uint32_t{info_.view_state} |
                                        std::uint32_t{info_.instance_state});
  }
  /// False if only the instance's state changed and only the key fields are set.
  bool valid() const { return info_.valid_data; }
  core::InstanceHandle instance_handle() const { return core::InstanceHandle(info_.instance_handle); }
  /// The writer of the sample.
  core::InstanceHandle publication_handle() const { return core::InstanceHandle(info_.publication_handle); }

private:
  dds_sample_info_t info_{};
};

/// A sample.
template <class T>
class SampleRef {
public:
  using DataType = T;

  SampleRef() = default;
  SampleRef(T data, const SampleInfo& info) : data_(std::move(data)), info_(info) {}
  const T& data() const { return data_; }
  const SampleInfo& info() const { return info_; }

private:
  T data_{};
  SampleInfo info_;
};

/// A range of samples; copies share it. It may outlive its reader.
template <class T>
class LoanedSamples {
  using Samples = std::vector<SampleRef<T>>;

public:
  using DataType = T;
  using const_iterator = typename Samples::const_iterator;

  LoanedSamples() = default;
  explicit LoanedSamples(Samples samples, std::shared_ptr<const void> memory = nullptr)
      : samples_(samples.empty() ? nullptr : std::make_shared<const Samples>(std::move(samples))),
        memory_(std::move(memory)) {}

  const_iterator begin() const { return samples_ == nullptr ? const_iterator() : samples_->begin(); }
  const_iterator end() const { return samples_ == nullptr ? const_iterator() : samples_->end(); }
  std::uint32_t length() const {
    return samples_ == nullptr ? 0 : static_cast<std::uint32_t>(samples_->size());
  }

private:
  std::shared_ptr<const Samples> samples_;
  std::shared_ptr<const void> memory_;  ///< strings and sequences of native samples; otherwise null
};

}  // namespace dds::inline sonopose_psm::sub
