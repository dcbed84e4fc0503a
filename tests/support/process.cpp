#include "support/process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

// The header of glibc 2.36 lacks extern "C".
extern "C" {
#include <sys/pidfd.h>
}

namespace sonopose::test {
namespace {

[[noreturn]] void fail(const char* call) {
  throw std::system_error(errno, std::generic_category(), call);
}

/// Read end and write end of a pipe.
std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe2");
  return ends;
}

std::vector<std::string> merged(const Environment& changes) {
  std::map<std::string, std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const std::size_t equals = text.find('=');
    variables.emplace(text.substr(0, equals), text.substr(equals + 1));
  }
  for (const auto& [name, value] : changes) variables[name] = value;
  std::vector<std::string> entries;
  for (const auto& [name, value] : variables) {
    if (!value.empty()) entries.emplace_back(name).append("=").append(value);
  }
  return entries;
}

/// Argument array for execve. The strings must outlive it.
std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

void ChildProcess::start(std::vector<std::string> command, const Environment& environment,
                         const std::function<void()>& attach) {
  std::vector<std::string> variables = merged(environment);
  const auto argument_list = pointers(command);
  const auto environment_list = pointers(variables);
  pid_ = ::fork();
  if (pid_ < 0) fail("fork");
  if (pid_ == 0) {                       // only async-signal-safe calls between fork and exec
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a killed test takes its programs along
    attach();
    ::close_range(STDERR_FILENO + 1, ~0U, 0);
    ::execve(argument_list.front(), argument_list.data(), environment_list.data());
    ::_exit(127);
  }
  file_ = ::pidfd_open(pid_, 0);
  if (file_ < 0) fail("pidfd_open");
}

void ChildProcess::send(int signal) const {
  if (!code_) ::kill(pid_, signal);
}

std::optional<int> ChildProcess::wait_for_exit(std::chrono::milliseconds limit) {
  if (code_) return code_;
  pollfd waited{file_, POLLIN, 0};
  if (::poll(&waited, 1, static_cast<int>(limit.count())) <= 0) return std::nullopt;
  int status = 0;
  if (::waitpid(pid_, &status, 0) != pid_) return std::nullopt;
  code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return code_;
}

void ChildProcess::kill() {
  if (pid_ < 0 || code_) return;
  send(SIGKILL);
  wait_for_exit();
}

ChildProcess::~ChildProcess() {
  kill();
  if (file_ >= 0) ::close(file_);
}

Process::Process(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const Environment& environment) {
  std::vector<std::string> command{program.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const auto output = make_pipe();
  const auto error = make_pipe();
  child_.start(std::move(command), environment, [&] {
    ::dup2(output[1], STDOUT_FILENO);
    ::dup2(error[1], STDERR_FILENO);
  });
  ::close(output[1]);
  ::close(error[1]);
  output_.file = output[0];
  error_.file = error[0];
  listener_ = std::thread([this] { listen(); });
}

Process::~Process() {
  child_.kill();
  listener_.join();
}

void Process::listen() {
  while (!output_.ended || !error_.ended) {
    std::array<pollfd, 2> waited{{{output_.file, POLLIN, 0}, {error_.file, POLLIN, 0}}};
    if (::poll(waited.data(), waited.size(), -1) < 0) continue;
    if (waited[0].revents != 0) take_in(output_);
    if (waited[1].revents != 0) take_in(error_);
  }
}

void Process::take_in(Pipe& pipe) {
  std::array<char, 4096> buffer{};
  const ssize_t got = ::read(pipe.file, buffer.data(), buffer.size());
  const std::lock_guard lock(mutex_);
  if (got <= 0) {
    ::close(pipe.file);
    pipe.file = -1;  // poll ignores it
    pipe.ended = true;
    if (!pipe.unfinished.empty()) pipe.lines.push_back(std::move(pipe.unfinished));
  }
  for (const char c : std::string_view(buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0)) {
    if (c != '\n') {
      pipe.unfinished += c;
      continue;
    }
    pipe.lines.push_back(std::move(pipe.unfinished));
    pipe.unfinished.clear();
  }
  news_.notify_all();
}

bool Process::wait_for_line(Stream stream, std::string_view text, std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  std::size_t looked_at = 0;
  bool found = false;
  const auto look = [&] {
    const auto& lines = pipe(stream).lines;
    while (!found && looked_at < lines.size()) {
      found = lines[looked_at++].find(text) != std::string::npos;
    }
    return found || pipe(stream).ended;
  };
  news_.wait_for(lock, limit, look);
  return found;
}

bool Process::wait_for_lines(Stream stream, std::size_t count, std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, limit, [&] { return pipe(stream).lines.size() >= count || pipe(stream).ended; });
  return pipe(stream).lines.size() >= count;
}

std::optional<int> Process::wait_for_exit(std::chrono::milliseconds limit) {
  const std::optional<int> code = child_.wait_for_exit(limit);
  if (!code) return std::nullopt;
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, limit, [this] { return output_.ended && error_.ended; });
  return code;
}

Process::Ending Process::end_by(int signal) {
  const auto began = std::chrono::steady_clock::now();
  send(signal);
  const auto code = wait_for_exit();
  const auto took = std::chrono::steady_clock::now() - began;
  return {code, std::chrono::duration_cast<std::chrono::milliseconds>(took)};
}

std::vector<std::string> Process::lines(Stream stream) const {
  const std::lock_guard lock(mutex_);
  return pipe(stream).lines;
}

std::string Process::text(Stream stream) const {
  std::string text;
  for (const std::string& line : lines(stream)) text += line + "\n";
  return text;
}

Result run(const std::filesystem::path& program, const std::vector<std::string>& arguments,
           const Environment& environment) {
  Process process(program, arguments, environment);
  const auto code = process.wait_for_exit();
  return {code, process.text(Process::Stream::output), process.text(Process::Stream::error)};
}

}  // namespace sonopose::test
