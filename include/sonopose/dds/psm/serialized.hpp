#pragma once
/// \file
/// Samples in wire format, read and written without decoding, for programs that record or forward any topic.
///
/// Cyclone DDS checks every arriving sample and converts one of the other byte order to the machine's own.
/// The encapsulation header has the byte order.

#include <sonopose/dds/psm/ext.hpp>

#include <dds/dds.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace sonopose::dds {

/// Stands in for a type. Its endpoints are made with `ext::serialized(topic)`.
struct Serialized {};

}  // namespace sonopose::dds

template <>
struct dds::topic::detail::TypeSupport<sonopose::dds::Serialized> {
  using C = sonopose::dds::Serialized;
};

namespace sonopose::dds {

using SerializedReader = sub::DataReader<Serialized>;
using SerializedWriter = pub::DataWriter<Serialized>;

/// Bytes of a sample, or of an instance's key, by reference. They stay in the memory of Cyclone DDS, also
/// after their reader is gone, but not after its domain. Move-only; any one thread at a time.
class SerializedSample {
public:
  SerializedSample() noexcept = default;
  /// Takes over one reference to `sample`.
  explicit SerializedSample(ddsi_serdata* sample) noexcept;
  SerializedSample(const SerializedSample&) = delete;
  SerializedSample& operator=(const SerializedSample&) = delete;
  SerializedSample(SerializedSample&& other) noexcept
      : sample_(std::exchange(other.sample_, nullptr)), bytes_(std::exchange(other.bytes_, {})) {}
  SerializedSample& operator=(SerializedSample&& other) noexcept {
    if (this != &other) {
      release();
      sample_ = std::exchange(other.sample_, nullptr);
      bytes_ = std::exchange(other.bytes_, {});
    }
    return *this;
  }
  ~SerializedSample() { release(); }

  /// Encapsulation header (4 bytes), then the CDR with the padding to 4 bytes that the header counts.
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

  /// Key of the sample's instance. Allocates.
  [[nodiscard]] SerializedSample key() const noexcept;

private:
  void release() noexcept;

  ddsi_serdata* sample_ = nullptr;
  std::span<const std::byte> bytes_;
};

namespace ext {

/// The topic, for endpoints that do not decode its samples.
template <class T>
topic::Topic<Serialized> serialized(const topic::Topic<T>& topic) {
  return topic::Topic<Serialized>(core::detail::Access::node(topic));
}

namespace detail {

/// Result of one take. Frees what the visitors did not get.
struct SerializedBatch {
  static constexpr std::int32_t capacity = 32;

  SerializedBatch() noexcept = default;
  SerializedBatch(const SerializedBatch&) = delete;
  SerializedBatch& operator=(const SerializedBatch&) = delete;
  ~SerializedBatch();
  ReturnCode take(dds_entity_t reader) noexcept;
  /// True if no later sample of the batch belongs to the same instance.
  [[nodiscard]] bool is_last_of_instance(std::size_t index, ReturnCode taken) const noexcept;
  /// True if the batch reports the end of the instance.
  [[nodiscard]] bool has_end_of(dds_instance_handle_t instance, ReturnCode taken) const noexcept;

  std::array<ddsi_serdata*, capacity> samples{};
  std::array<dds_sample_info_t, capacity> infos;  // NOLINT(*-member-init): dds_takecdr fills in what is used
};

/// End of an instance whose sample is the last of a full batch.
struct HeldEnd {
  bool is_set = false;
  SerializedSample key;
  dds_sample_info_t info{};
};

}  // namespace detail

/// Takes all available samples, oldest first within an instance. Calls `on_sample(SerializedSample&&, const
/// sub::SampleInfo&)` for each with data. Calls `on_end(SerializedSample&& key, const sub::SampleInfo&)` for
/// each instance that was disposed of or lost its writers, after its last sample. Returns the number of
/// samples, or a negative return code. Throws only what the visitors throw.
template <class OnSample, class OnEnd>
ReturnCode try_take_each(const SerializedReader& reader, OnSample&& on_sample, OnEnd&& on_end) {
  using Batch = detail::SerializedBatch;
  const dds_entity_t c_reader = try_handle(reader);
  if (c_reader < 0) return c_reader;
  ReturnCode total = 0;
  ReturnCode taken = Batch::capacity;
  detail::HeldEnd held;
  while (taken == Batch::capacity) {
    Batch batch;
    taken = batch.take(c_reader);
    if (held.is_set && !batch.has_end_of(held.info.instance_handle, taken)) {
      on_end(std::move(held.key), sub::SampleInfo(held.info));
    }
    held.is_set = false;
    if (taken <= 0) return taken < 0 ? taken : total;
    for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i) {
      SerializedSample sample(std::exchange(batch.samples[i], nullptr));
      const sub::SampleInfo info(batch.infos[i]);
      if (!info.valid()) {
        if (!is_alive(info)) on_end(std::move(sample), info);
        continue;
      }
      // An end that follows untaken samples has no sample of its own: the info of the last of them reports
      // it.
      const bool ended = !is_alive(info) && batch.is_last_of_instance(i, taken);
      SerializedSample key = ended ? sample.key() : SerializedSample();
      on_sample(std::move(sample), info);
      if (!ended) continue;
      if (i + 1 == batch.infos.size()) {  // the next batch may have more of this instance
        held = {true, std::move(key), batch.infos[i]};
      } else {
        on_end(std::move(key), info);
      }
    }
    total += taken;
  }
  return total;
}

/// Meaning of the bytes to forward, and their effect on the instance.
enum class Change : std::uint8_t {
  write,      ///< a sample
  dispose,    ///< key of an instance that ends
  unregister  ///< key of an instance that this writer gives up
};

/// Forwards `bytes`, which begin with the encapsulation header, in XCDR1 of either byte order.
/// `source_timestamp_ns` is since the Unix epoch. Returns a negative code for bytes that are not of the
/// topic's type, and timeouts like `try_write`. Cyclone DDS does not dispose of an instance that is only
/// unregistered here, whatever the writer's QoS.
ReturnCode try_forward(const SerializedWriter& writer, std::span<const std::byte> bytes,
                       std::int64_t source_timestamp_ns, Change change = Change::write) noexcept;

/// Like `try_forward`, but throws.
inline void forward(const SerializedWriter& writer, std::span<const std::byte> bytes,
                    std::int64_t source_timestamp_ns, Change change = Change::write) {
  core::detail::check("dds_forwardcdr", try_forward(writer, bytes, source_timestamp_ns, change));
}

}  // namespace ext
}  // namespace sonopose::dds
