#pragma once
/// \file
/// Finds where the clock of a log was set back, which all of its files show.

#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace sonopose::recording {

/// A stamp that is earlier than the one before it.
struct StepBack {
  std::size_t index = 0;  ///< number of samples before it
  TimeNs before_ns = 0;
  TimeNs after_ns = 0;
  std::size_t older = 0;  ///< later samples whose stamps are before the step
};

/// The steps back of one stream.
class StepsBack {
public:
  void add(TimeNs stamp_ns) {
    if (newest_ns_ && stamp_ns < *newest_ns_) found_.push_back({count_, *newest_ns_, stamp_ns, 0});
    if (!found_.empty() && stamp_ns < found_.back().before_ns) ++found_.back().older;
    newest_ns_ = stamp_ns;
    ++count_;
  }
  [[nodiscard]] const std::vector<StepBack>& found() const { return found_; }
  [[nodiscard]] bool has_samples() const { return count_ > 0; }

private:
  std::vector<StepBack> found_;
  std::size_t count_ = 0;
  std::optional<TimeNs> newest_ns_;
};

/// For each stream the samples at which it is cut: those after a step back of more than 0.1 s that each
/// stream with samples shows at the same time, and that lasts in the first one. Empty lists without other
/// streams.
std::vector<std::vector<std::size_t>> cuts_at_common_steps(const std::vector<StepsBack>& streams);

/// The steps back of a stream of samples, in the order in which they are available.
template <class Stream>
StepsBack steps_back_of(Stream stream) {
  StepsBack steps;
  for (; stream.current() != nullptr; stream.step()) steps.add(available_at_ns(*stream.current()));
  return steps;
}

/// A stream that ends at each cut, until the next piece begins.
template <class Stream>
class Pieces {
public:
  Pieces(Stream stream, std::vector<std::size_t> cuts) : stream_(std::move(stream)), cuts_(std::move(cuts)) {}

  [[nodiscard]] const auto* current() const {
    const bool is_at_cut = piece_ < cuts_.size() && passed_ == cuts_[piece_];
    return is_at_cut ? nullptr : stream_.current();
  }
  void step() {
    ++passed_;
    stream_.step();
  }
  void begin_next() { ++piece_; }
  [[nodiscard]] const Stream& stream() const { return stream_; }

private:
  Stream stream_;
  std::vector<std::size_t> cuts_;
  std::size_t passed_ = 0;
  std::size_t piece_ = 0;
};

}  // namespace sonopose::recording
