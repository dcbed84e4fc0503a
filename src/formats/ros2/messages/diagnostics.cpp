#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/diagnostics.hpp>
#include <sonopose/ros2/messages/messages.hpp>

namespace sonopose::ros2 {

DiagnosticMessage::DiagnosticMessage(const std::vector<Diagnostic>& diagnostics, TimeNs stamp_ns) {
  values_.reserve(diagnostics.size());
  for (const Diagnostic& diagnostic : diagnostics) {
    std::vector<KeyValue>& values = values_.emplace_back();
    for (const auto& [key, value] : diagnostic.values)
      values.push_back({borrow_string(key), borrow_string(value)});
    DiagnosticStatus status{};
    status.level = static_cast<std::uint8_t>(diagnostic.level);
    status.name = borrow_string(diagnostic.name);
    status.message = borrow_string(diagnostic.message);
    status.hardware_id = borrow_string(diagnostic.hardware_id);
    borrow_sequence(status.values, values);
    statuses_.push_back(status);
  }
  message_.header = header_of(stamp_ns, frame_id_);
  borrow_sequence(message_.status, statuses_);
}

}  // namespace sonopose::ros2
