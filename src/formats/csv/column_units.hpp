#pragma once
/// \file
/// The units that a header can name: `w_x [deg s^-1]`.

#include <optional>
#include <string>
#include <string_view>

namespace sonopose::csv {

/// Factor that converts values in `unit` to `wanted`; empty if they are of different quantities, or if either
/// is unknown.
std::optional<long double> unit_factor(std::string_view unit, std::string_view wanted);

/// Returns true if some quantity has this unit.
bool is_unit(std::string_view unit);

/// Names of the units of the quantity that `unit` belongs to: "ns, us, ms, s".
std::string units_like(std::string_view unit);

}  // namespace sonopose::csv
