#pragma once
/// \file
/// Understands Cyclone DDS's messages about processes that DDS Security refused. Internal to this module.

#include <sonopose/dds/binding/refused_peer.hpp>

#include <deque>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::dds {

/// Collects refusals from messages. Cyclone DDS repeats them each second. Thread-safe.
class Refusals {
public:
  /// Meaning of a message for the log.
  struct Verdict {
    bool is_about_refusal = false;  ///< the message itself says no more than `text`
    std::string text;               ///< names a newly refused process; empty if there is none
  };

  Verdict on_message(std::string_view message);

  [[nodiscard]] std::vector<RefusedPeer> peers() const;

private:
  Verdict refuse(RefusedPeer peer);

  mutable std::mutex mutex_;
  std::set<std::string> known_;
  bool is_full_ = false;              ///< more were refused than are known
  std::deque<std::string> suspects_;  ///< secured processes that were refused once, the latest last
  std::vector<RefusedPeer> peers_;
};

}  // namespace sonopose::dds
