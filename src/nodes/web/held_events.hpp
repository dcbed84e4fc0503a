#pragma once
/// \file
/// Holds changes of state seen in the poses until it is known whether a fusion logs them.

#include "transitions/line.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::web {

/// Events wait for two calls of `take_due`: a fusion's line may arrive before or after its pose.
class HeldEvents {
public:
  static constexpr std::size_t max_events = 200;   ///< limit at a time; of more, the latest
  static constexpr std::size_t max_logged = 1000;  ///< limit between two calls; more are not recognised

  /// `line_text`: text of the corresponding log line; `event`: text for the page.
  void hold(std::string_view line_text, std::string event) {
    if (new_.size() == max_events) {
      new_.erase(new_.begin());
      ++dropped_;
    }
    new_.push_back({std::string(transitions::change_of(line_text)), std::move(event)});
  }

  /// Reports a line that a fusion has logged.
  void on_logged(std::string_view line_text) {
    if (logged_.front().size() < max_logged) logged_.front().emplace(transitions::change_of(line_text));
  }

  /// Returns the events held at the previous call, without changes that a fusion has logged. Call it once a
  /// second.
  std::vector<std::string> take_due() {
    std::vector<std::string> events;
    for (Held& held : due_) {
      const bool is_logged = std::any_of(logged_.begin(), logged_.end(),
                                         [&](const auto& each) { return each.contains(held.change); });
      if (!is_logged) events.push_back(std::move(held.event));
    }
    due_ = std::exchange(new_, {});
    std::rotate(logged_.begin(), logged_.end() - 1, logged_.end());
    logged_.front().clear();
    return events;
  }

  /// Number of events without space since the last call.
  std::uint64_t take_dropped() { return std::exchange(dropped_, 0); }

private:
  struct Held {
    std::string change;
    std::string event;
  };

  std::vector<Held> new_;
  std::vector<Held> due_;
  std::uint64_t dropped_ = 0;
  /// Logged changes since the last call, then those of the two periods before it.
  std::array<std::set<std::string, std::less<>>, 3> logged_;
};

}  // namespace sonopose::web
