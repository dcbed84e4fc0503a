// Readers.

#include "dds/psm/effective_qos.hpp"
#include <sonopose/dds/psm/dds/sub/ddssub.hpp>

#include <dds/ddsc/dds_internal_api.h>

#include <algorithm>

namespace dds::inline sonopose_psm::sub {

using core::detail::check;

namespace detail {

std::shared_ptr<ReaderNode> make_node(const core::Reference& subscriber, const core::Reference& topic,
                                      const qos::DataReaderQos& qos) {
  return core::detail::make_endpoint<ReaderNode>(subscriber, topic, qos);
}

void open(ReaderNode& reader, const core::detail::Callbacks& callbacks) {
  core::detail::open_endpoint(reader, "dds_create_reader", dds_create_reader, callbacks);
}

Fetched::Fetched(const core::detail::Node& node, const Selection& selection,
                 const dds_topic_descriptor_t& type)
    : type_(type) {
  if (selection.of_one_instance && selection.instance == DDS_HANDLE_NIL) {
    throw core::PreconditionNotMetError("nil is no instance to read");
  }
  if (selection.max_samples == 0) return;
  const core::detail::Pin pin(node);  // an entity that ends meanwhile would stay locked
  const dds_entity_t reader = node.handle();
  const std::uint32_t available = dds_reader_lock_samples(reader);  // locks only if there are any
  if (available == 0) return;
  const std::uint32_t size = std::min({available, selection.max_samples, 0x7fffffffU});
  std::vector<void*> samples;
  try {
    samples.reserve(size);
    memory_.resize(std::size_t{size} * type.m_size);
    infos_.resize(size);
    for (std::size_t i = 0; i < size; ++i) samples.push_back(&memory_[i * type.m_size]);
  } catch (...) {
    void* none = this;
    dds_sample_info_t info;  // NOLINT(*-member-init): no instance has this handle, so the call only unlocks
    dds_read_instance_mask(reader, &none, &info, 1, DDS_READ_WITHOUT_LOCK, ~dds_instance_handle_t{0}, 0);
    throw;
  }
  const auto call = [&](auto all, auto of_instance) -> dds_return_t {
    return selection.of_one_instance
               ? of_instance(reader, samples.data(), infos_.data(), size, DDS_READ_WITHOUT_LOCK,
                             selection.instance, selection.mask)
               : all(reader, samples.data(), infos_.data(), size, DDS_READ_WITHOUT_LOCK, selection.mask);
  };
  const dds_return_t count = selection.take ? call(dds_take_mask, dds_take_instance_mask)
                                            : call(dds_read_mask, dds_read_instance_mask);
  infos_.resize(static_cast<std::size_t>(check(selection.take ? "dds_take" : "dds_read", count)));
}

Fetched::~Fetched() {
  if ((type_.m_flagset & DDS_TOPIC_FIXED_SIZE) != 0) return;
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    dds_sample_free(&memory_[i * type_.m_size], &type_, DDS_FREE_CONTENTS);
  }
}

}  // namespace detail

void AnyDataReader::wait_for_historical_data(const core::Duration& timeout) {
  check("dds_reader_wait_for_historical_data",
        dds_reader_wait_for_historical_data(node().handle(), core::detail::to_c(timeout)));
}

}  // namespace dds::inline sonopose_psm::sub
