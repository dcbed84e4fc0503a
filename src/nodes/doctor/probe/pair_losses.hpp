#pragma once
/// \file
/// Detects times in which the fixes of a pair have no heading.

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <utility>

namespace sonopose::doctor::probe {

/// Compares valid headings with fixes in pieces of four seconds. A longer loss of the pair leaves too few
/// headings in at least one piece. Not thread-safe.
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

  /// Total length of the pieces in which less than half of the fixes have a heading.
  [[nodiscard]] double lost_s(TimeNs now_ns) const {
    PairLosses ended = *this;
    ended.update(now_ns);
    // The rest at the end counts if it is at least half a piece.
    if (2 * (now_ns - ended.piece_began_ns_) >= piece_ns) ended.end_piece(now_ns - ended.piece_began_ns_);
    return static_cast<double>(ended.lost_ns_) * 1e-9;
  }

private:
  static constexpr TimeNs piece_ns = 4'000'000'000;
  static constexpr std::uint64_t min_fixes = 4;

  void update(TimeNs now_ns) {
    if (now_ns - piece_began_ns_ < piece_ns) return;
    end_piece(piece_ns);
    piece_began_ns_ += (now_ns - piece_began_ns_) / piece_ns * piece_ns;
  }
  void end_piece(TimeNs length_ns) {
    const auto fixes = std::exchange(fixes_, 0);
    const auto headings = std::exchange(headings_, 0);
    if (fixes >= min_fixes && 2 * headings < fixes) lost_ns_ += length_ns;
  }

  TimeNs piece_began_ns_ = 0;
  TimeNs lost_ns_ = 0;
  std::uint64_t fixes_ = 0;
  std::uint64_t headings_ = 0;
};

}  // namespace sonopose::doctor::probe
