#pragma once
/// \file
/// A topic that writes and reads serialized samples.

#include "support/test_domain.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace sonopose::test {

using Bytes = std::vector<std::uint8_t>;

/// Access to serialized data through Cyclone DDS's C API; errors throw std::runtime_error.
class RawTopic {
public:
  explicit RawTopic(const dds_topic_descriptor_t& descriptor)
      : participant_(dds::ext::participant({.domain_id = domain_.id()})) {
    const dds_entity_t topic =
        good(dds_create_topic(dds::ext::handle(participant_), &descriptor, "rt/raw", nullptr, nullptr));
    dds::Qos qos;
    qos << dds::policy::Reliability::Reliable() << dds::policy::History::KeepLast(10);
    reader_ = good(dds_create_reader(dds::ext::handle(participant_), topic, qos.get(), nullptr));
    writer_ = good(dds_create_writer(dds::ext::handle(participant_), topic, qos.get(), nullptr));
  }

  /// Serialized `sample` with its encapsulation header.
  Bytes bytes_of(const void* sample) {
    ddsi_serdata* const data = sent(sample);
    Bytes bytes(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data);
    return bytes;
  }

  /// Calls `use` with the deserialized sample. `any` is a sample of the same type.
  template <class T, class Use>
  void read(Bytes bytes, const T& any, const Use& use) {
    ddsi_serdata* const other = sent(&any);
    ddsrt_iovec_t part{};
    part.iov_base = bytes.data();
    part.iov_len = bytes.size();
    ddsi_serdata* const data = ddsi_serdata_from_ser_iov(other->type, SDK_DATA, 1, &part, bytes.size());
    ddsi_serdata_unref(other);
    if (data == nullptr) throw std::runtime_error("these bytes are no sample");
    data->timestamp.v = dds_time();
    good(dds_forwardcdr(writer_, data));
    void* sample = nullptr;
    dds_sample_info_t info;
    if (good(dds_take(reader_, &sample, &info, 1, 1)) != 1) throw std::runtime_error("no sample came");
    use(*static_cast<const T*>(sample));
    good(dds_return_loan(reader_, &sample, 1));
  }

private:
  static dds_return_t good(dds_return_t code) {
    if (code < 0) throw std::runtime_error(dds_strretcode(code));
    return code;
  }

  ddsi_serdata* sent(const void* sample) {
    good(dds_write(writer_, sample));
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info;
    if (good(dds_takecdr(reader_, &data, 1, &info, DDS_ANY_STATE)) != 1) {
      throw std::runtime_error("no sample came");
    }
    return data;
  }

  TestDomain domain_;
  dds::domain::DomainParticipant participant_;
  dds_entity_t reader_ = 0;
  dds_entity_t writer_ = 0;
};

}  // namespace sonopose::test
