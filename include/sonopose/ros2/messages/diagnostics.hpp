#pragma once
/// \file
/// Diagnostics for the dashboards of ROS 2: one status per component.

#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::ros2 {

/// Levels of diagnostic_msgs/DiagnosticStatus.
enum class Level : std::uint8_t { ok, warning, error, stale };

struct Diagnostic {
  Level level = Level::ok;
  std::string name;         ///< `node: task`
  std::string message;      ///< a short text
  std::string hardware_id;  ///< beacon's address
  std::vector<std::pair<std::string, std::string>> values;
};

/// A message for writing. It borrows the strings of `diagnostics`, which must outlive it.
class DiagnosticMessage {
public:
  DiagnosticMessage(const std::vector<Diagnostic>& diagnostics, TimeNs stamp_ns);
  DiagnosticMessage(const DiagnosticMessage&) = delete;
  DiagnosticMessage& operator=(const DiagnosticMessage&) = delete;
  ~DiagnosticMessage() = default;

  [[nodiscard]] const DiagnosticArray& message() const { return message_; }

private:
  std::string frame_id_;  // empty: diagnostics have no frame
  std::vector<std::vector<KeyValue>> values_;
  std::vector<DiagnosticStatus> statuses_;
  DiagnosticArray message_{};
};

}  // namespace sonopose::ros2
