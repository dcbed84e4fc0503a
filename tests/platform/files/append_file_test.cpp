#include "files/append_file.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <span>
#include <string>

namespace append_file_test {

using namespace sonopose::files;
using namespace sonopose::test;
using Catch::Contains;

SCENARIO("a file is extended at once") {
  const TemporaryFolder folder;
  const std::string text("\xFF\x47\0\n", 4);
  const auto extend = [bytes = std::as_bytes(std::span(text))](const std::filesystem::path& file) {
    AppendFile(file, AppendFile::Existing::extend).append(bytes);
  };
  extend(folder / "capture.bin");
  CHECK(read_text(folder / "capture.bin") == text);
  AppendFile file(folder / "capture.bin", AppendFile::Existing::extend);
  file.append(std::as_bytes(std::span(text)));
  CHECK(read_text(folder / "capture.bin") == text + text);
  THEN("a folder that does not exist, and a full disk, are reported") {
    CHECK_THROWS_WITH(extend(folder / "none" / "capture.bin"), Contains("cannot be created: No such file"));
    CHECK_THROWS_WITH(extend("/dev/full"), Contains("/dev/full: cannot be written: No space left"));
  }
}

}  // namespace append_file_test
