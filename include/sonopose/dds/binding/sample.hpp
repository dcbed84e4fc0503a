#pragma once
/// \file
/// Samples on loan from Cyclone DDS, each with its `SampleInfo`.

#include <sonopose/dds/binding/types.hpp>

#include <dds/dds.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

namespace sonopose::dds {

/// Metadata of a sample.
class SampleInfo {
public:
  explicit SampleInfo(const dds_sample_info_t& info) : info_(&info) {}

  /// False if only the instance's state changed and only the key fields are set.
  bool valid() const noexcept { return info_->valid_data; }
  /// Time of writing, ns since the Unix epoch, in the writer's clock or as the writer specified.
  std::int64_t source_timestamp_ns() const noexcept { return info_->source_timestamp; }
  InstanceHandle instance_handle() const noexcept { return {info_->instance_handle}; }
  /// Writer of the sample.
  InstanceHandle publication_handle() const noexcept { return {info_->publication_handle}; }
  /// True if the instance has a living writer that did not dispose of it.
  bool alive() const noexcept { return info_->instance_state == DDS_IST_ALIVE; }
  bool disposed() const noexcept { return info_->instance_state == DDS_IST_NOT_ALIVE_DISPOSED; }
  bool no_writers() const noexcept { return info_->instance_state == DDS_IST_NOT_ALIVE_NO_WRITERS; }
  /// True if the instance was not seen before, or is back.
  bool new_instance() const noexcept { return info_->view_state == DDS_VST_NEW; }
  /// True if the sample was read before.
  bool read_before() const noexcept { return info_->sample_state == DDS_SST_READ; }

private:
  const dds_sample_info_t* info_;
};

/// One sample of a loan, valid as long as the loan.
template <class T>
class Sample {
public:
  Sample(const void* data, const dds_sample_info_t& info) : data_(static_cast<const T*>(data)), info_(info) {}

  const T& data() const noexcept { return *data_; }
  const SampleInfo& info() const noexcept { return info_; }

private:
  const T* data_;
  SampleInfo info_;
};

/// A range of samples on loan from Cyclone DDS, returned on destruction. It must not outlive the reader.
template <class T>
class LoanedSamples {
public:
  class Iterator {
  public:
    using value_type = Sample<T>;
    using difference_type = std::ptrdiff_t;

    Iterator() = default;
    Iterator(const LoanedSamples* samples, std::size_t index) : samples_(samples), index_(index) {}
    Sample<T> operator*() const { return (*samples_)[index_]; }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++index_;
      return before;
    }
    bool operator==(const Iterator&) const = default;

  private:
    const LoanedSamples* samples_ = nullptr;
    std::size_t index_ = 0;
  };

  LoanedSamples() = default;
  /// Takes over the loan of `dds_take` or `dds_read`; the vectors have one element for each sample.
  LoanedSamples(dds_entity_t reader, std::vector<void*> data, std::vector<dds_sample_info_t> infos)
      : reader_(reader), data_(std::move(data)), infos_(std::move(infos)) {}
  LoanedSamples(const LoanedSamples&) = delete;
  LoanedSamples& operator=(const LoanedSamples&) = delete;
  LoanedSamples(LoanedSamples&& other) noexcept
      : reader_(other.reader_),
        data_(std::exchange(other.data_, {})),
        infos_(std::exchange(other.infos_, {})) {}
  LoanedSamples& operator=(LoanedSamples&& other) noexcept {
    if (this != &other) {
      return_loan();
      reader_ = other.reader_;
      data_ = std::exchange(other.data_, {});
      infos_ = std::exchange(other.infos_, {});
    }
    return *this;
  }
  ~LoanedSamples() { return_loan(); }

  /// Returns the loan now.
  void return_loan() noexcept {
    if (!data_.empty()) dds_return_loan(reader_, data_.data(), static_cast<std::int32_t>(data_.size()));
    data_.clear();
    infos_.clear();
  }

  std::size_t length() const noexcept { return data_.size(); }
  std::size_t size() const noexcept { return data_.size(); }
  bool empty() const noexcept { return data_.empty(); }
  Sample<T> operator[](std::size_t index) const { return Sample<T>(data_[index], infos_[index]); }
  Iterator begin() const { return Iterator(this, 0); }
  Iterator end() const { return Iterator(this, size()); }

private:
  dds_entity_t reader_ = 0;
  std::vector<void*> data_;
  std::vector<dds_sample_info_t> infos_;
};

}  // namespace sonopose::dds
