#include <sonopose/ros2/messages/diagnostics.hpp>
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/messages.hpp>

namespace sonopose::ros2 {

DiagnosticMessage::DiagnosticMessage(const std::vector<Diagnostic>& diagnostics, TimeNs stamp_ns) {
  values_.reserve(diagnostics.size());
  for (const Diagnostic& diagnostic : diagnostics) {
    std::vector<KeyValue>& values = values_.emplace_back();
    for (const auto& [key, value] : diagnostic.values) values.push_back({lent(key), lent(value)});
    DiagnosticStatus status{};
    status.level = static_cast<std::uint8_t>(diagnostic.level);
    status.name = lent(diagnostic.name);
    status.message = lent(diagnostic.message);
    status.hardware_id = lent(diagnostic.hardware_id);
    lend(status.values, values);
    statuses_.push_back(status);
  }
  message_.header = header_of(stamp_ns, frame_id_);
  lend(message_.status, statuses_);
}

}  // namespace sonopose::ros2
