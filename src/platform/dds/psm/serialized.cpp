#include <sonopose/dds/psm/serialized.hpp>

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/q_protocol.h>

#include <algorithm>
#include <cstring>

namespace sonopose::dds {
namespace {

/// Bytes for one call of dds_forwardcdr, which converts them to the type of any writer. It only requests the
/// serialized form. Owns neither the bytes nor its own memory.
struct ForeignSample {
  ddsi_serdata base;
  std::span<const std::byte> bytes;
};

const ForeignSample& foreign(const ddsi_serdata* sample) {
  return *reinterpret_cast<const ForeignSample*>(sample);  // NOLINT(*-reinterpret-cast): its first member
}

std::uint32_t size_of(const ddsi_serdata* sample) {
  return static_cast<std::uint32_t>(foreign(sample).bytes.size());
}

void copy(const ddsi_serdata* sample, std::size_t offset, std::size_t size, void* to) {
  std::memcpy(to, foreign(sample).bytes.data() + offset, size);
}

ddsi_serdata* refer(const ddsi_serdata* sample, std::size_t offset, std::size_t size, ddsrt_iovec_t* to) {
  to->iov_base = const_cast<std::byte*>(foreign(sample).bytes.data() + offset);  // NOLINT(*-const-cast): C
  to->iov_len = size;
  return ddsi_serdata_ref(sample);
}

void end_reference(ddsi_serdata* sample, const ddsrt_iovec_t* /*reference*/) {
  ddsi_serdata_unref(sample);
}

void free_nothing(ddsi_serdata* /*sample*/) {}

ddsi_serdata_ops foreign_sample_operations() {
  ddsi_serdata_ops operations{};
  operations.get_size = size_of;
  operations.to_ser = copy;
  operations.to_ser_ref = refer;
  operations.to_ser_unref = end_reference;
  operations.free = free_nothing;
  return operations;
}

/// The type of such samples: of the current version, and different from that of every writer.
struct ForeignType {
  ForeignType() {
    operations.version = ddsi_sertype_v0;
    type.ops = &operations;
    type.serdata_ops = &sample_operations;
  }

  ddsi_serdata_ops sample_operations = foreign_sample_operations();
  ddsi_sertype_ops operations{};
  ddsi_sertype type{};
};

const ddsi_sertype& foreign_type() {
  static const ForeignType instance;
  return instance.type;
}

std::uint32_t status_of(ext::Change change) {
  switch (change) {
    case ext::Change::write:
      return 0;
    case ext::Change::dispose:
      return NN_STATUSINFO_DISPOSE;
    case ext::Change::unregister:
      return NN_STATUSINFO_UNREGISTER;
  }
  return 0;
}

/// Returns true if Cyclone DDS 0.10.2 reads the encoding within bounds. Samples must have the first version
/// of CDR (cdr.hpp). Keys may also have the second one, which it gives them itself.
bool is_readable(std::span<const std::byte> bytes, ext::Change change) {
  constexpr std::size_t header_size = 4;
  if (bytes.size() < header_size || bytes[0] != std::byte{0}) return false;
  const unsigned encoding = std::to_integer<unsigned>(bytes[1]) & ~1U;  // without the byte order
  return encoding == 0 || (encoding == 6 && change != ext::Change::write);
}

}  // namespace

SerializedSample::SerializedSample(ddsi_serdata* sample) noexcept {
  if (sample == nullptr) return;
  // Holds the bytes, and with them the sample.
  ddsrt_iovec_t bytes{};
  sample_ = ddsi_serdata_to_ser_ref(sample, 0, ddsi_serdata_size(sample), &bytes);
  bytes_ = {static_cast<const std::byte*>(bytes.iov_base), bytes.iov_len};
  ddsi_serdata_unref(sample);
}

SerializedSample SerializedSample::key() const noexcept {
  return sample_ == nullptr ? SerializedSample() : SerializedSample(ddsi_serdata_to_untyped(sample_));
}

void SerializedSample::release() noexcept {
  if (sample_ == nullptr) return;
  ddsrt_iovec_t bytes{};
  bytes.iov_base = const_cast<std::byte*>(bytes_.data());  // NOLINT(*-const-cast): C
  bytes.iov_len = bytes_.size();
  ddsi_serdata_to_ser_unref(sample_, &bytes);
  sample_ = nullptr;
  bytes_ = {};
}

namespace ext {
namespace detail {

SerializedBatch::~SerializedBatch() {
  for (ddsi_serdata* sample : samples) {
    if (sample != nullptr) ddsi_serdata_unref(sample);
  }
}

ReturnCode SerializedBatch::take(dds_entity_t reader) noexcept {
  return dds_takecdr(reader, samples.data(), capacity, infos.data(), DDS_ANY_STATE);
}

bool SerializedBatch::is_last_of_instance(std::size_t index, ReturnCode taken) const noexcept {
  const auto* const first = infos.begin() + static_cast<std::ptrdiff_t>(index) + 1;
  return std::none_of(first, infos.begin() + taken, [&](const dds_sample_info_t& later) {
    return later.instance_handle == infos[index].instance_handle;
  });
}

bool SerializedBatch::has_end_of(dds_instance_handle_t instance, ReturnCode taken) const noexcept {
  return taken > 0 && std::any_of(infos.begin(), infos.begin() + taken, [&](const dds_sample_info_t& info) {
           return info.instance_handle == instance && info.instance_state != DDS_IST_ALIVE;
         });
}

}  // namespace detail

ReturnCode try_forward(const SerializedWriter& writer, std::span<const std::byte> bytes,
                       std::int64_t source_timestamp_ns, Change change) noexcept {
  if (!is_readable(bytes, change) || source_timestamp_ns < 0) return DDS_RETCODE_BAD_PARAMETER;
  const dds_entity_t c_writer = try_handle(writer);
  if (c_writer < 0) return c_writer;
  ForeignSample sample{{}, bytes};
  ddsi_serdata_init(&sample.base, &foreign_type(), change == Change::write ? SDK_DATA : SDK_KEY);
  sample.base.statusinfo = status_of(change);
  sample.base.timestamp.v = source_timestamp_ns;
  return dds_forwardcdr(c_writer, &sample.base);
}

}  // namespace ext
}  // namespace sonopose::dds
