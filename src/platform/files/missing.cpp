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
  if (error) throw IoError(opening_error(folder.string(), error.value()));
  throw IoError(folder.string() + ": is not a folder");
}

bool is_present(const std::filesystem::path& path) {
  std::error_code error;
  const bool present = std::filesystem::exists(path, error);
  if (error) throw IoError(opening_error(path.string(), error.value()));
  return present;
}

}  // namespace sonopose::files
