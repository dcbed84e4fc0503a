#pragma once
/// \file
/// Reads serialized samples of one type like Cyclone DDS from the network.

#include "support.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace sonopose::fuzz {

/// The participant of this process, which meets no other one.
inline const dds::domain::DomainParticipant& participant() {
  static const auto instance = dds::ext::participant({.domain_id = dds::max_domain_id});
  return instance;
}

template <class T>
class CdrType {
public:
  CdrType() : topic_(participant(), "fuzz", {}) {
    // Cyclone DDS shows the serializer of a type only in a sample that a reader took.
    dds::Qos qos;
    qos << dds::policy::Reliability::Reliable();
    const dds_entity_t reader =
        dds_create_reader(dds::ext::handle(participant()), dds::ext::handle(topic_), qos.get(), nullptr);
    const dds_entity_t writer =
        dds_create_writer(dds::ext::handle(participant()), dds::ext::handle(topic_), qos.get(), nullptr);
    const T empty{};
    dds_sample_info_t info;
    promise(dds_write(writer, &empty) == DDS_RETCODE_OK, "an empty sample can be written");
    promise(dds_takecdr(reader, &any_, 1, &info, DDS_ANY_STATE) == 1, "a written sample can be taken");
    dds_delete(reader);
    dds_delete(writer);
  }
  ~CdrType() { ddsi_serdata_unref(any_); }
  CdrType(const CdrType&) = delete;
  CdrType& operator=(const CdrType&) = delete;

  /// Calls `use(const T&)` if Cyclone DDS accepts the bytes: an encapsulation header, then the sample. Only
  /// XCDR1: Cyclone DDS 0.10.2 reads an array of doubles in XCDR2 beyond the end of the sample (its pull
  /// request 1559).
  template <class Use>
  void read(std::span<const std::uint8_t> bytes, const Use& use) const {
    if (bytes.size() < 2 || bytes[0] != 0 || bytes[1] > 1) return;
    std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
    ddsrt_iovec_t part{};
    part.iov_base = copy.data();
    part.iov_len = copy.size();
    ddsi_serdata* const data = ddsi_serdata_from_ser_iov(any_->type, SDK_DATA, 1, &part, copy.size());
    if (data == nullptr) return;
    T sample{};
    if (ddsi_serdata_to_sample(data, &sample, nullptr, nullptr)) use(std::as_const(sample));
    dds_sample_free(&sample, &dds::TopicTraits<T>::descriptor(), DDS_FREE_CONTENTS);
    ddsi_serdata_unref(data);
  }

private:
  dds::topic::Topic<T> topic_;
  ddsi_serdata* any_ = nullptr;
};

}  // namespace sonopose::fuzz
