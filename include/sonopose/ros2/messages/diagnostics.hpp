#pragma once
/// \file
/// Diagnostics as robots' dashboards read them: one status for each thing that can be well or not.

#include <sonopose/samples/samples.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::ros2 {

/// diagnostic_msgs/DiagnosticStatus's own numbers.
enum class Level : std::uint8_t { ok, warning, error, stale };

struct Diagnostic {
  Level level = Level::ok;
  std::string name;         ///< `node: task`
  std::string message;      ///< in a few words
  std::string hardware_id;  ///< the beacon's address
  std::vector<std::pair<std::string, std::string>> values;
};

/// A message for writing; its texts lead into `diagnostics`, which must outlive it.
class DiagnosticMessage {
public:
  DiagnosticMessage(const std::vector<Diagnostic>& diagnostics, TimeNs stamp_ns);
  DiagnosticMessage(const DiagnosticMessage&) = delete;
  DiagnosticMessage& operator=(const DiagnosticMessage&) = delete;
  DiagnosticMessage(DiagnosticMessage&&) = delete;
  DiagnosticMessage& operator=(DiagnosticMessage&&) = delete;
  ~DiagnosticMessage() = default;

  [[nodiscard]] const DiagnosticArray& message() const { return message_; }

private:
  std::string frame_id_;  // none: a dashboard has no place
  std::vector<std::vector<KeyValue>> values_;
  std::vector<DiagnosticStatus> statuses_;
  DiagnosticArray message_{};
};

}  // namespace sonopose::ros2
