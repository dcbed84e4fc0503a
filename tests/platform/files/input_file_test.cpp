/// Files that a user has given: what can be read, and what is refused without waiting.

#include "files/input_file.hpp"

#include "files/line_reader.hpp"
#include "files/random_access_file.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
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

/// A terminal of which only our end is open.
struct UnopenedTerminal {
  UnopenedTerminal() {
    REQUIRE(::grantpt(our_end) == 0);
    REQUIRE(::unlockpt(our_end) == 0);
    std::array<char, 64> text{};
    REQUIRE(::ptsname_r(our_end, text.data(), text.size()) == 0);
    name = text.data();
  }
  ~UnopenedTerminal() { ::close(our_end); }
  UnopenedTerminal(const UnopenedTerminal&) = delete;
  UnopenedTerminal& operator=(const UnopenedTerminal&) = delete;

  /// Returns true once the other end was opened and closed.
  [[nodiscard]] bool was_opened() const {
    pollfd state{.fd = our_end, .events = 0, .revents = 0};
    return ::poll(&state, 1, 0) == 1 && (state.revents & POLLHUP) != 0;
  }

  int our_end = ::posix_openpt(O_RDWR | O_NOCTTY);
  std::string name;
};

SCENARIO("a serial line is refused without being opened") {
  const UnopenedTerminal terminal;
  check_refused(terminal.name, "a device, not a file");
  CHECK_FALSE(terminal.was_opened());
  ::close(::open(terminal.name.c_str(), O_RDWR | O_NOCTTY));
  CHECK(terminal.was_opened());
}

/// Replaces the standard input during its lifetime.
class StandardInput {
public:
  explicit StandardInput(int replacement) { ::dup2(replacement, STDIN_FILENO); }
  ~StandardInput() {
    ::dup2(before_, STDIN_FILENO);
    ::close(before_);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

private:
  int before_ = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
};

SCENARIO("the standard input is read, from a file and from a pipe") {
  const TemporaryFolder folder;
  sonopose::test::write_text(folder / "file", "text\n");
  int ends[2] = {};
  REQUIRE(::pipe(ends) == 0);
  REQUIRE(::write(ends[1], "text\n", 5) == 5);
  ::close(ends[1]);
  const Descriptor pipe(ends[0]);
  const Descriptor file = open_input(folder / "file");
  const auto* const source = GENERATE("a file", "a pipe");
  CAPTURE(source);
  const StandardInput input(source == std::string("a file") ? file.number() : pipe.number());
  WHEN("it is read as a whole") {
    CHECK(read_text("/dev/stdin") == "text\n");
  }
  WHEN("it is read by lines") {
    LineReader lines("/dev/stdin");
    CHECK(lines.next() == "text");
    CHECK_FALSE(lines.next());
  }
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
