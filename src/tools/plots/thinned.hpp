#pragma once
/// \file
/// A series that is thinned while it grows.

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace sonopose::plots {

/// A series of at most `max_entries` entries, each of the same number of consecutive values. `merge(into,
/// next)` joins two.
template <class T>
class Thinned {
public:
  using Merge = std::function<void(T& into, const T& next)>;

  Thinned(std::size_t max_entries, Merge merge) : max_(max_entries), merge_(std::move(merge)) {}

  void add(const T& value) {
    if (in_last_ > 0 && in_last_ < per_entry_) {
      merge_(entries_.back(), value);
      ++in_last_;
      return;
    }
    if (entries_.size() == max_) halve();
    entries_.push_back(value);
    in_last_ = 1;
  }

  [[nodiscard]] const std::vector<T>& entries() const { return entries_; }

private:
  void halve() {
    for (std::size_t i = 0; i < entries_.size() / 2; ++i) {
      T pair = entries_[2 * i];
      merge_(pair, entries_[2 * i + 1]);
      entries_[i] = pair;
    }
    entries_.resize(entries_.size() / 2);
    per_entry_ *= 2;
  }

  std::size_t max_;
  Merge merge_;
  std::vector<T> entries_;
  std::size_t per_entry_ = 1;
  std::size_t in_last_ = 0;
};

}  // namespace sonopose::plots
