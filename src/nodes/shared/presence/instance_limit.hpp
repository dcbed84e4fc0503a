#pragma once
/// \file
/// Bounds the instances of topics with a second key, such as the id of a fusion.

#include "threads/mutex.hpp"
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::presence {

/// Traits of bounded instances: fusions of each beacon, lines of all bridges, or processes that log.
template <class T>
struct Instance {
  using Group = BeaconAddress;
  using Key = std::uint64_t;
  static constexpr std::size_t max_at_a_time = 8;  ///< a fusion, its standbys, and restarted ones
  static constexpr const char* group = "fusions of a beacon";
  static constexpr const char* one_was = "fusion was";
  static constexpr const char* several_were = "fusions were";
  static Group group_of(const T& sample) { return sample.address; }
  static Key key_of(const T& sample) { return sample.fusion_id; }
};
template <>
struct Instance<sonopose_LineStatus> {
  using Group = std::uint8_t;
  using Key = std::pair<std::string, std::uint64_t>;
  static constexpr std::size_t max_at_a_time = 256;
  static constexpr const char* group = "lines";
  static constexpr const char* one_was = "line was";
  static constexpr const char* several_were = "lines were";
  static Group group_of(const sonopose_LineStatus& /*sample*/) { return 0; }
  static Key key_of(const sonopose_LineStatus& sample) { return {sample.name, sample.bridge_id}; }
};
template <>
struct Instance<sonopose_LogLine> {
  using Group = std::uint8_t;
  using Key = std::pair<std::string, std::uint64_t>;
  static constexpr std::size_t max_at_a_time = 64;
  static constexpr const char* group = "processes that log";
  static Group group_of(const sonopose_LogLine& /*sample*/) { return 0; }
  static Key key_of(const sonopose_LogLine& sample) { return {sample.host, sample.process_id}; }
};

/// Filter of one reader that accepts the first instances. DDS keeps each instance until its writers have
/// ended, so a writer that invents keys must not create more. Thread-safe.
template <class T>
class InstanceLimit {
public:
  /// Largest number of different instances since the start: a disposed one may still have a writer.
  static constexpr std::size_t max_ever = 32'768;

  /// `addresses`, if given, judges the address first, and must outlive this object.
  explicit InstanceLimit(dds::topics::AddressFilter* addresses = nullptr) : addresses_(addresses) {}

  bool accepts(const T& sample) noexcept {
    if constexpr (requires { sample.address; }) {
      if (addresses_ != nullptr && !addresses_->accepts(sample.address)) return false;
    }
    const Id id{Traits::group_of(sample), Traits::key_of(sample)};
    const threads::Lock lock(mutex_);
    std::vector<Key>& present = present_[id.first];
    if (std::find(present.begin(), present.end(), id.second) != present.end()) return true;
    const bool may_be_known = ever_.size() < max_ever || ever_.contains(id);
    if (present.size() >= Traits::max_at_a_time || !may_be_known) {
      ++refused_;
      if (refused_ids_.size() < max_ever && !ever_.contains(id)) refused_ids_.insert(id);
      return false;
    }
    refused_ids_.erase(id);
    present.push_back(id.second);
    ever_.insert(id);
    return true;
  }

  /// Frees the place of an instance that is gone.
  void forget(const T& key) noexcept {
    const threads::Lock lock(mutex_);
    const auto present = present_.find(Traits::group_of(key));
    if (present == present_.end()) return;
    std::erase(present->second, Traits::key_of(key));
    if (present->second.empty()) present_.erase(present);
  }

  /// A message for the user when the first sample is refused, and each time ten times as many are. Otherwise
  /// empty.
  std::optional<std::string> refusals() {
    const threads::Lock lock(mutex_);
    if (refused_ == 0 || refused_ < 10 * reported_) return std::nullopt;
    reported_ = refused_;
    return fmt::format("{} ignored: {}", text::count_text(refused_, "sample is", "samples are"),
                       limit_text());
  }

  /// Final message with the number of instances that were never accepted; empty if there were none.
  std::optional<std::string> warning() {
    const threads::Lock lock(mutex_);
    if (refused_ids_.empty()) return std::nullopt;
    return fmt::format("{} not observed: {}",
                       text::count_text(refused_ids_.size(), Traits::one_was, Traits::several_were),
                       limit_text());
  }

private:
  using Traits = Instance<T>;
  using Key = typename Traits::Key;
  using Id = std::pair<typename Traits::Group, Key>;

  static std::string limit_text() {
    return fmt::format("the limit is {} {} at a time and {} different ones since the start",
                       Traits::max_at_a_time, Traits::group, max_ever);
  }

  dds::topics::AddressFilter* addresses_;
  threads::Mutex mutex_;
  std::map<typename Traits::Group, std::vector<Key>> present_ SONOPOSE_GUARDED_BY(mutex_);
  std::set<Id> ever_ SONOPOSE_GUARDED_BY(mutex_);
  std::set<Id> refused_ids_ SONOPOSE_GUARDED_BY(mutex_);  ///< at most max_ever
  std::uint64_t refused_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::uint64_t reported_ SONOPOSE_GUARDED_BY(mutex_) = 0;
};

}  // namespace sonopose::presence
