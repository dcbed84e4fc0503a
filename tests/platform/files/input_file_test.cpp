/// Files that a user has given: what can be read, and what is refused without waiting.

#include "files/input_file.hpp"

#include "files/error.hpp"
#include "files/line_reader.hpp"
#include "files/random_access_file.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace input_file_test {

using namespace sonopose::files;
using Catch::Contains;
using sonopose::test::TemporaryFolder;

/// Checks that no reader takes the file, and that each says what it is instead.
void check_refused(const std::filesystem::path& file, const std::string& kind) {
  INFO(file);
  CHECK_THROWS_WITH(read_text(file), Contains(file.string() + ": is " + kind));
  CHECK_THROWS_WITH(LineReader(file), Contains(file.string() + ": is " + kind));
  CHECK_THROWS_WITH(RandomAccessFile(file), Contains(file.string() + ": is " + kind));
}

SCENARIO("what is not a file is refused by its kind") {
  const TemporaryFolder folder;
  check_refused(folder.path(), "a folder, not a file");
  check_refused("/dev/zero", "a device, not a file");

  const auto pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);  // without a writer: opening it the usual way waits for ever
  check_refused(pipe, "a named pipe, not a file");

  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string socket_file = (folder / "s").string();
  REQUIRE(socket_file.copy(address.sun_path, sizeof address.sun_path - 1) == socket_file.size());
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  REQUIRE(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  check_refused(socket_file, "a socket");
  ::close(socket);

  CHECK_THROWS_WITH(read_text(folder / "none"), Contains("none: does not exist"));
}

SCENARIO("a file, the shell's pipe and the null device are read to their end") {
  const TemporaryFolder folder;
  const std::string text("a\r\n\0b", 5);
  sonopose::test::write_text(folder / "file", text);
  CHECK(read_text(folder / "file") == text);
  CHECK(read_text("/dev/null").empty());

  int ends[2] = {};
  REQUIRE(::pipe(ends) == 0);
  REQUIRE(::write(ends[1], text.data(), text.size()) == 5);
  ::close(ends[1]);
  CHECK(read_text("/dev/fd/" + std::to_string(ends[0])) == text);
  ::close(ends[0]);
}

SCENARIO("a file above the limit is refused") {
  const TemporaryFolder folder;
  sonopose::test::write_text(folder / "large", "");
  std::filesystem::resize_file(folder / "large", max_text_bytes + 1);  // sparse
  CHECK_THROWS_WITH(read_text(folder / "large"), Contains("large: has more than 67108864 bytes"));
}

}  // namespace input_file_test
