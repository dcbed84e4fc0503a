#include "recorder/trigger.hpp"

#include "dds/topics/cdr_cursor.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/idl/field_visitors.hpp>

#include <string_view>
#include <type_traits>

namespace sonopose::recorder {
namespace {

/// Reads over a value of final types, up to the field `last`, which is then at the cursor.
template <class Value>
bool skip_to(dds::topics::CdrCursor& cursor, const Value& value, std::string_view last) {
  if constexpr (std::is_array_v<Value>) {
    for (const auto& element : value) skip_to(cursor, element, {});
    return false;
  } else if constexpr (std::is_arithmetic_v<Value>) {
    if constexpr (sizeof(Value) == 8) cursor.read<std::uint64_t>();
    if constexpr (sizeof(Value) == 4) cursor.read<std::uint32_t>();
    if constexpr (sizeof(Value) == 2) cursor.read<std::uint16_t>();
    if constexpr (sizeof(Value) == 1) cursor.read<std::uint8_t>();
    return false;
  } else {
    bool found = false;
    idl::visit_fields(value, [&](std::string_view name, const auto& field) {
      if (found) return;
      found = !last.empty() && name == last;
      if (!found) skip_to(cursor, field, {});
    });
    return found;
  }
}

}  // namespace

const char* words_of(TriggerCause cause) {
  switch (cause) {
    case TriggerCause::none:
      return "no trigger";
    case TriggerCause::signal:
      return "a signal";
    case TriggerCause::topic:
      return "a sample of the trigger topic";
    case TriggerCause::status:
      return "the status of a pose";
  }
  return "";
}

std::uint32_t status_in(std::span<const std::byte> pose) {
  dds::topics::CdrCursor cursor(pose);
  skip_to(cursor, sonopose_FusedPose{}, "status");
  return cursor.read<std::uint32_t>();
}

void BadStatusTrigger::on_sample(std::span<const std::byte> pose) noexcept {
  const auto address = dds::topics::beacon_of(pose);
  if (!address) return;
  const std::uint32_t status = status_in(pose);
  const bool is_good = (status & bad_status) == 0;
  if (!is_good && was_good_.test(*address)) trigger_.fire(TriggerCause::status);
  was_good_.set(*address, is_good && (status & status_initialising) == 0);
}

}  // namespace sonopose::recorder
