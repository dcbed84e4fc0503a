#pragma once
/// \file
/// Schemas of the encoding `omgidl`: which of them describe the same type.

#include <string>
#include <string_view>

namespace sonopose::mcap {

/// The definition of a struct such as "sonopose::ImuSample" in the text of an IDL file, with those of the
/// types and constants that it uses, and without comments and spaces that mean nothing. Empty if the text
/// does not define it.
std::string definition_in(std::string_view idl, std::string_view type_name);

}  // namespace sonopose::mcap
