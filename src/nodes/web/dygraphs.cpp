#include "web/dygraphs.hpp"

#include "files/error.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace sonopose::web {

std::string dygraphs_file(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(SONOPOSE_DYGRAPHS_FOLDER) / name;
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (text.empty()) {
    throw files::IoError(file.string() + ": cannot be read; the page needs Debian's package libjs-dygraphs");
  }
  return text;
}

}  // namespace sonopose::web
