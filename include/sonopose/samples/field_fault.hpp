#pragma once
/// \file
/// What is wrong with a saved state.

#include <string_view>

namespace sonopose {

/// A field of a state, and what is impossible about its value.
struct FieldFault {
  std::string_view field;
  std::string_view fault;
};

}  // namespace sonopose
