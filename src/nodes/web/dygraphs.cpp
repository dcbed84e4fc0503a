#include "web/dygraphs.hpp"

#include "files/error.hpp"
#include "files/input_file.hpp"

#include <filesystem>
#include <string>

namespace sonopose::web {

std::string dygraphs_file(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(SONOPOSE_DYGRAPHS_FOLDER) / name;
  try {
    return files::read_text(file);
  } catch (const files::IoError& error) {
    throw files::IoError(std::string(error.what()) + "; the page needs Debian's package libjs-dygraphs");
  }
}

}  // namespace sonopose::web
