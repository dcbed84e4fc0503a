#pragma once
/// \file
/// Strings and sequences of a message for writing, as views without copies. The owner of the data must
/// outlive the message.

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// A view of `text`. The strings of idlc's types are not const because a reader owns them; writing does not
/// modify them.
inline char* borrow_string(const std::string& text) {
  return const_cast<char*>(text.c_str());  // NOLINT(*-const-cast)
}

/// Makes `sequence`, a sequence type of idlc, a view of `values`.
template <class Sequence, class Value>
void borrow_sequence(Sequence& sequence, std::vector<Value>& values) {
  const auto length = static_cast<std::uint32_t>(values.size());
  sequence = {length, length, values.data(), false};
}

}  // namespace sonopose::ros2
