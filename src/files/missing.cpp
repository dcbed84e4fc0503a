#include "files/missing.hpp"

#include "files/error.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

namespace sonopose::files {

std::string opening_error(const std::string& name, int error) {
  if (error == ENOENT) return name + ": does not exist";
  return name + ": cannot be opened: " + std::strerror(error);
}

void require_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const auto kind = std::filesystem::status(folder, error).type();
  if (kind == std::filesystem::file_type::directory) return;
  const bool is_absent = kind == std::filesystem::file_type::not_found;
  throw IoError(folder.string() + (is_absent ? ": does not exist" : ": is not a folder"));
}

}  // namespace sonopose::files
