#include "page/library.hpp"

#include "files/error.hpp"
#include "page/assets.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace sonopose::page {

std::string library_file(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(dygraphs_folder) / name;
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (text.empty()) {
    throw files::IoError(file.string() + ": cannot be read; a page needs Debian's package libjs-dygraphs");
  }
  return text;
}

}  // namespace sonopose::page
