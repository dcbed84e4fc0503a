#pragma once
/// \file
/// Samples in wire format, read and written without decoding, for programs that record or forward any topic.
///
/// Cyclone DDS checks every arriving sample and converts one of the other byte order to the machine's own.
/// The encapsulation header has the byte order.

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/data_writer.hpp>

#include <dds/dds.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace sonopose::dds {

/// Stands in for a type: `DataReader<Serialized>`.
struct Serialized {};

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

/// Takes the samples of a topic without decoding.
template <>
class DataReader<Serialized> : public Entity {
public:
  DataReader() noexcept = default;

  /// `listener` must outlive the reader and receives the statuses in `mask`.
  template <class T>
  DataReader(const DomainParticipant& participant, const Topic<T>& topic, const Qos& qos = {},
             DataReaderListener<Serialized>* listener = nullptr, StatusMask mask = StatusMask::all())
      : Entity(check("dds_create_reader", topic.name(),
                     dds_create_reader(participant.handle(), topic.handle(), qos.get(),
                                       detail::c_listener(listener, mask).get()))) {}

  /// A non-owning view of a reader.
  static DataReader borrow(dds_entity_t handle) noexcept {
    // The constructor is explicit. NOLINTNEXTLINE(modernize-return-braced-init-list)
    return DataReader(handle, Ownership::borrowed);
  }

  /// Takes all available samples, oldest first within an instance. Calls `on_sample(SerializedSample&&, const
  /// SampleInfo&)` for each with data. Calls `on_end(SerializedSample&& key, const SampleInfo&)` for each
  /// instance that was disposed of or lost its writers, after its last sample. Returns the number of samples,
  /// or a negative return code. Throws only what the visitors throw.
  template <class OnSample, class OnEnd>
  ReturnCode try_take_each(OnSample&& on_sample, OnEnd&& on_end) {
    ReturnCode total = 0;
    ReturnCode taken = Batch::capacity;
    HeldEnd held;
    while (taken == Batch::capacity) {
      Batch batch;
      taken = batch.take(handle());
      if (held.is_set && !batch.has_end_of(held.info.instance_handle, taken)) {
        on_end(std::move(held.key), SampleInfo(held.info));
      }
      held.is_set = false;
      if (taken <= 0) return taken < 0 ? taken : total;
      for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i) {
        SerializedSample sample(std::exchange(batch.samples[i], nullptr));
        const SampleInfo info(batch.infos[i]);
        if (!info.valid()) {
          if (!info.alive()) on_end(std::move(sample), info);
          continue;
        }
        // An end that follows untaken samples has no sample of its own: the info of the last of them reports
        // it.
        const bool ended = !info.alive() && batch.is_last_of_instance(i, taken);
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

  SubscriptionMatchedStatus subscription_matched_status();
  SampleLostStatus sample_lost_status();

private:
  using Entity::Entity;

  /// Result of one take. Frees what the visitors did not get.
  struct Batch {
    static constexpr std::int32_t capacity = 32;

    Batch() noexcept = default;
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;
    Batch(Batch&&) = delete;
    Batch& operator=(Batch&&) = delete;
    ~Batch();
    ReturnCode take(dds_entity_t reader) noexcept;
    /// True if no later sample of the batch belongs to the same instance.
    [[nodiscard]] bool is_last_of_instance(std::size_t index, ReturnCode taken) const noexcept;
    /// True if the batch reports the end of the instance.
    [[nodiscard]] bool has_end_of(dds_instance_handle_t instance, ReturnCode taken) const noexcept;

    std::array<ddsi_serdata*, capacity> samples{};
    std::array<dds_sample_info_t, capacity>
        infos;  // NOLINT(*-member-init): dds_takecdr fills in what is used
  };

  /// End of an instance whose sample is the last of a full batch.
  struct HeldEnd {
    bool is_set = false;
    SerializedSample key;
    dds_sample_info_t info{};
  };
};

using SerializedReader = DataReader<Serialized>;

/// Writes samples that are already serialized.
class SerializedWriter : public Entity {
public:
  /// Meaning of the bytes, and their effect on the instance.
  enum class Change : std::uint8_t {
    write,      ///< a sample
    dispose,    ///< key of an instance that ends
    unregister  ///< key of an instance that this writer gives up
  };

  SerializedWriter() noexcept = default;

  template <class T>
  SerializedWriter(const DomainParticipant& participant, const Topic<T>& topic, const Qos& qos = {})
      : Entity(check("dds_create_writer", topic.name(),
                     dds_create_writer(participant.handle(), topic.handle(), qos.get(), nullptr))) {}

  /// Forwards `bytes`, which begin with the encapsulation header, in XCDR1 of either byte order.
  /// `source_timestamp_ns` is since the Unix epoch. Returns a negative code for bytes that are not of the
  /// topic's type, and timeouts like DataWriter::try_write. Cyclone DDS does not dispose of an instance that
  /// is only unregistered here, whatever the writer's QoS.
  ReturnCode try_forward(std::span<const std::byte> bytes, std::int64_t source_timestamp_ns,
                         Change change = Change::write) noexcept;

  /// Like `try_forward`, but throws `Error`.
  void forward(std::span<const std::byte> bytes, std::int64_t source_timestamp_ns,
               Change change = Change::write) {
    check("dds_forwardcdr", try_forward(bytes, source_timestamp_ns, change));
  }

  /// Sends pending samples if the domain batches writes (DomainOptions::batch_writes).
  void flush() noexcept { dds_write_flush(handle()); }

  /// True if all readers acknowledged all samples within `timeout`.
  bool wait_for_acknowledgments(Duration timeout);

  PublicationMatchedStatus publication_matched_status();
};

}  // namespace sonopose::dds
