#include <sonopose/ros2/diagnostics.hpp>
#include <sonopose/ros2/messages.hpp>

namespace sonopose::ros2 {
namespace {

/// Whoever reads a message owns its texts, so they are not const there; nobody writes into one that is
/// written.
char* text(const std::string& string) {
  return const_cast<char*>(string.c_str());  // NOLINT(*-const-cast)
}

/// An IDL sequence that leads into `items` and owns nothing.
template <class Sequence, class Item>
Sequence view_of(std::vector<Item>& items) {
  const auto length = static_cast<std::uint32_t>(items.size());
  return {length, length, items.data(), false};
}

}  // namespace

DiagnosticMessage::DiagnosticMessage(const std::vector<Diagnostic>& diagnostics, TimeNs stamp_ns) {
  values_.reserve(diagnostics.size());
  for (const Diagnostic& diagnostic : diagnostics) {
    std::vector<KeyValue>& values = values_.emplace_back();
    for (const auto& [key, value] : diagnostic.values) values.push_back({text(key), text(value)});
    DiagnosticStatus status{};
    status.level = static_cast<std::uint8_t>(diagnostic.level);
    status.name = text(diagnostic.name);
    status.message = text(diagnostic.message);
    status.hardware_id = text(diagnostic.hardware_id);
    status.values = view_of<decltype(status.values)>(values);
    statuses_.push_back(status);
  }
  message_.header = header_of(stamp_ns, frame_id_);
  message_.status = view_of<decltype(message_.status)>(statuses_);
}

}  // namespace sonopose::ros2
