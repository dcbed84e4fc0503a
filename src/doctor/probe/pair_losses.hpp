#pragma once
/// \file
/// Parts of the window in which the fixes of a pair have no heading.

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <utility>

namespace sonopose::doctor::probe {

/// Compares the valid headings with the fixes, in pieces of four seconds: a pair that is lost for longer has
/// too few in one of them. Not thread-safe.
class PairLosses {
public:
  void begin(TimeNs now_ns) { piece_began_ns_ = now_ns; }
  void on_fix(TimeNs now_ns) {
    update(now_ns);
    ++fixes_;
  }
  void on_heading(TimeNs now_ns) {
    update(now_ns);
    ++headings_;
  }

  /// The length of the pieces in which less than half of the fixes have a heading.
  [[nodiscard]] double lost_s(TimeNs now_ns) const {
    PairLosses ended = *this;
    ended.update(now_ns);
    // What is left at the end says something from half a piece on.
    if (2 * (now_ns - ended.piece_began_ns_) >= piece_ns) ended.end_piece(now_ns - ended.piece_began_ns_);
    return static_cast<double>(ended.lost_ns_) * 1e-9;
  }

private:
  static constexpr TimeNs piece_ns = 4'000'000'000;
  static constexpr std::uint64_t least_fixes = 4;

  void update(TimeNs now_ns) {
    if (now_ns - piece_began_ns_ < piece_ns) return;
    end_piece(piece_ns);
    piece_began_ns_ += (now_ns - piece_began_ns_) / piece_ns * piece_ns;
  }
  void end_piece(TimeNs length_ns) {
    const auto fixes = std::exchange(fixes_, 0);
    const auto headings = std::exchange(headings_, 0);
    if (fixes >= least_fixes && 2 * headings < fixes) lost_ns_ += length_ns;
  }

  TimeNs piece_began_ns_ = 0;
  TimeNs lost_ns_ = 0;
  std::uint64_t fixes_ = 0;
  std::uint64_t headings_ = 0;
};

}  // namespace sonopose::doctor::probe
