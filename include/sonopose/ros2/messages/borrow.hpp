#pragma once
/// \file
/// Texts and lists of a message that is to be written: lent to it, not copied. What is lent must outlive the
/// message.

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Whoever reads a message owns its texts, so idlc's are not const; nobody writes into one that is written.
inline char* lent(const std::string& text) {
  return const_cast<char*>(text.c_str());  // NOLINT(*-const-cast)
}

/// `values` as a sequence of idlc's.
template <class Sequence, class Value>
void lend(Sequence& sequence, std::vector<Value>& values) {
  const auto length = static_cast<std::uint32_t>(values.size());
  sequence = {length, length, values.data(), false};
}

}  // namespace sonopose::ros2
