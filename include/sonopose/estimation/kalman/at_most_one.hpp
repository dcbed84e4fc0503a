#pragma once
/// \file
/// An optional part of a state, which costs nothing in hash and state file while it is absent.

#include <cstddef>
#include <optional>

namespace sonopose::estimation::kalman {

/// A sequence of at most one record, in place.
template <class Record>
class AtMostOne {
public:
  using value_type = Record;
  static constexpr std::size_t capacity = 1;

  [[nodiscard]] std::size_t size() const { return record_ ? 1 : 0; }
  [[nodiscard]] bool accepts(const Record& /*record*/) const { return true; }
  void push(const Record& record) { record_ = record; }
  [[nodiscard]] const Record& operator[](std::size_t /*i*/) const { return *record_; }

  explicit operator bool() const { return record_.has_value(); }
  [[nodiscard]] const Record& operator*() const { return *record_; }
  [[nodiscard]] Record& operator*() { return *record_; }
  [[nodiscard]] const Record* operator->() const { return &*record_; }
  [[nodiscard]] Record* operator->() { return &*record_; }
  bool operator==(const AtMostOne&) const = default;

private:
  std::optional<Record> record_;
};

}  // namespace sonopose::estimation::kalman
