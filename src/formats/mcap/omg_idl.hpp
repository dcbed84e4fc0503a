#pragma once
/// \file
/// Finds out which schemas of the encoding `omgidl` describe the same type.

#include <string>
#include <string_view>

namespace sonopose::mcap {

/// Returns the definition of a struct such as "sonopose::ImuSample" in an IDL text. It includes the types and
/// constants that the struct uses, and omits comments and meaningless spaces. Empty if the text does not
/// define it.
std::string definition_in(std::string_view idl, std::string_view type_name);

}  // namespace sonopose::mcap
