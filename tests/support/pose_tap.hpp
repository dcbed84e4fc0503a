#pragma once
/// \file
/// A live consumer of poses that records the arrival time and the writer of each.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"

#include <condition_variable>
#include <mutex>
#include <set>
#include <vector>

namespace sonopose::test {

struct TappedPose {
  FusedPose pose;
  std::uint64_t writer = 0;  ///< publication handle
  SteadyTime received;
};

class PoseTap {
public:
  explicit PoseTap(const Bus& bus, const std::string& partition = {})
      : participant_(dds::ext::participant({.domain_id = bus.domain_id(), .partition = partition})),
        reader_(dds::topics::make_reader(participant_, dds::qos::Provider(), dds::topics::pose, &listener_)) {
  }

  /// Currently matched writers.
  [[nodiscard]] std::set<std::uint64_t> writers() const {
    std::set<std::uint64_t> handles;
    for (const auto handle : dds::ext::matched_publications(reader_)) handles.insert(handle.c_value());
    return handles;
  }

  /// Ownership strength of this writer.
  [[nodiscard]] std::int32_t strength_of(std::uint64_t writer) const {
    dds_builtintopic_endpoint_t* data = dds_get_matched_publication_data(dds::ext::handle(reader_), writer);
    REQUIRE(data != nullptr);
    std::int32_t strength = 0;
    dds_qget_ownership_strength(data->qos, &strength);
    dds_builtintopic_free_endpoint(data);
    return strength;
  }

  /// Number of received poses.
  [[nodiscard]] std::size_t count() const {
    const std::lock_guard lock(listener_.mutex);
    return listener_.poses.size();
  }

  /// Poses from index `first` on.
  [[nodiscard]] std::vector<TappedPose> since(std::size_t first) const {
    const std::lock_guard lock(listener_.mutex);
    const auto begin = listener_.poses.begin() + static_cast<std::ptrdiff_t>(first);
    return {begin, listener_.poses.end()};
  }

  /// Waits for a pose that fulfils `predicate`, including those received from index `from`. Empty after the
  /// timeout.
  template <class Predicate>
  std::optional<TappedPose> wait_for(const Predicate& predicate, std::size_t from,
                                     std::chrono::milliseconds limit = timeout) const {
    std::unique_lock lock(listener_.mutex);
    std::optional<TappedPose> found;
    listener_.came.wait_for(lock, limit, [&] {
      for (; !found && from < listener_.poses.size(); ++from) {
        if (predicate(listener_.poses[from])) found = listener_.poses[from];
      }
      return found.has_value();
    });
    return found;
  }

  /// Waits for `count` poses from index `first` on, and returns them.
  [[nodiscard]] std::vector<TappedPose> wait_for_count(std::size_t first, std::size_t count) const {
    {
      std::unique_lock lock(listener_.mutex);
      listener_.came.wait_for(lock, timeout, [&] { return listener_.poses.size() >= first + count; });
    }
    return since(first);
  }

  /// Waits for a pose from one of these writers.
  std::optional<TappedPose> wait_for_writer(const std::set<std::uint64_t>& writers, std::size_t from) const {
    return wait_for([&](const TappedPose& tapped) { return writers.contains(tapped.writer); }, from);
  }

  /// Waits until a writer loses its liveliness after `after`; returns the time. Empty after the timeout.
  std::optional<SteadyTime> wait_for_loss(SteadyTime after) const {
    std::unique_lock lock(listener_.mutex);
    const bool lost = listener_.came.wait_for(lock, timeout, [&] { return listener_.lost_at >= after; });
    return lost ? std::optional(listener_.lost_at) : std::nullopt;
  }

  /// Returns true if a writer has lost its liveliness after `after`.
  [[nodiscard]] bool has_loss(SteadyTime after) const {
    const std::lock_guard lock(listener_.mutex);
    return listener_.lost_at >= after;
  }

private:
  struct Listener final : dds::sub::NoOpDataReaderListener<sonopose_FusedPose> {
    void on_data_available(dds::sub::DataReader<sonopose_FusedPose>& reader) noexcept override {
      const SteadyTime received = clocks::steady_now();
      const std::lock_guard lock(mutex);
      dds::ext::try_take_each(reader, [&](const sonopose_FusedPose& pose, const dds::sub::SampleInfo& info) {
        poses.push_back({dds::topics::from_idl(pose), info.publication_handle().c_value(), received});
      });
      came.notify_all();
    }

    void on_liveliness_changed(dds::sub::DataReader<sonopose_FusedPose>& /*reader*/,
                               const dds::core::status::LivelinessChangedStatus& status) noexcept override {
      if (status.not_alive_count_change() <= 0) return;
      const std::lock_guard lock(mutex);
      lost_at = clocks::steady_now();
      came.notify_all();
    }

    mutable std::mutex mutex;
    mutable std::condition_variable came;
    std::vector<TappedPose> poses;
    SteadyTime lost_at;  ///< time of the last loss of a writer's liveliness
  };

  Listener listener_;
  dds::domain::DomainParticipant participant_;
  dds::sub::DataReader<sonopose_FusedPose> reader_;
};

}  // namespace sonopose::test
