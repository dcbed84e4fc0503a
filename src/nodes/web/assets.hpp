#pragma once
/// \file
/// The page's own files, which are compiled into the program.

#include <span>
#include <string_view>

namespace sonopose::web {

struct Asset {
  std::string_view name;  ///< path in web/
  std::string_view content_type;
  std::string_view text;
};

std::span<const Asset> assets();

}  // namespace sonopose::web
