#pragma once
/// \file
/// A fault of a saved state.

#include <concepts>
#include <string_view>
#include <type_traits>

namespace sonopose {

/// `Group` or `const Group`, for functions that visit the fields of either.
template <class T, class Group>
concept IsFieldsOf = std::same_as<std::remove_const_t<T>, Group>;

/// A field of a state and its fault.
struct FieldFault {
  std::string_view field;
  std::string_view fault;
};

}  // namespace sonopose
