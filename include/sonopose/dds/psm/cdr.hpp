#pragma once
/// \file
/// Conversion of samples from and to their serialized form, without a participant: for recordings, for
/// example.

#include <sonopose/dds/psm/ext.hpp>

#include <dds/dds.h>

#include <bit>
#include <cstddef>
#include <span>
#include <vector>

namespace sonopose::dds {

/// Reads a serialized sample, from its encapsulation header on, into `sample`, which is zero. Its sequences
/// then belong to the sample (dds_sample_free). Returns false if the bytes are not a whole sample of the type
/// and its padding, or not in XCDR1 of either byte order. Cyclone DDS 0.10.2 reads an array of doubles in
/// XCDR2 beyond its end.
bool read_cdr(std::span<const std::byte> cdr, const dds_topic_descriptor_t& type, void* sample);

/// Serializes a sample in XCDR1, with its encapsulation header.
std::vector<std::byte> write_cdr(const void* sample, const dds_topic_descriptor_t& type,
                                 std::endian byte_order = std::endian::native);

template <class T>
std::vector<std::byte> write_cdr(const T& sample, std::endian byte_order = std::endian::native) {
  return write_cdr(&sample, TopicTraits<T>::descriptor(), byte_order);
}

/// A sample read from its serialized form.
template <class T>
class CdrSample {
public:
  explicit CdrSample(std::span<const std::byte> cdr)
      : is_valid_(read_cdr(cdr, TopicTraits<T>::descriptor(), &sample_)) {}
  ~CdrSample() { dds_sample_free(&sample_, &TopicTraits<T>::descriptor(), DDS_FREE_CONTENTS); }
  CdrSample(const CdrSample&) = delete;
  CdrSample& operator=(const CdrSample&) = delete;

  /// The sample; null if the bytes are invalid.
  [[nodiscard]] const T* get() const { return is_valid_ ? &sample_ : nullptr; }

private:
  T sample_{};
  bool is_valid_;
};

}  // namespace sonopose::dds
