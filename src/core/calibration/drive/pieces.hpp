#pragma once
/// \file
/// Parts of a log between silences of the IMU. Private to this folder.

#include "calibration/drive/likelihood.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace sonopose::calibration::drive::detail {

/// Interval between two samples above which the motion between them is unknown.
inline constexpr double min_silence_s = 0.25;

/// Shortest part of a log in which the filter settles and something is left to judge.
inline constexpr double min_piece_s = 6.0;

/// Cuts a log at the silences of its IMU and appends the pieces, without those shorter than `min_piece_s`. A
/// model of the motion in a silence would be wrong by more than the delay that is searched. A piece has only
/// the fixes and headings that keep `margin_s` to its ends.
void append_pieces(const Measurements& log, std::vector<Measurements>& pieces);

/// The log with the stamps of its fixes and headings set back by a delay.
Measurements set_back(Measurements log, double delay_s);

/// Number of silences of the IMU.
std::size_t silences_in(const Measurements& log);

/// Duration of all pieces.
double duration_s(std::span<const Measurements> pieces);

}  // namespace sonopose::calibration::drive::detail
