#include "faults/cast.hpp"

#include "clocks/clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace sonopose::faults {
namespace {

using test::Arguments;
using test::Process;
using Stream = Process::Stream;

/// Runs a program under a shell limit: `limit` precedes `program arguments`.
std::unique_ptr<Process> limited(const std::string& limit, const std::string& program,
                                 const Arguments& arguments, const test::Environment& environment) {
  Arguments all{"-c", limit + R"(; exec "$0" "$@")", program};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return std::make_unique<Process>("/bin/sh", all, environment);
}

#ifdef __SANITIZE_THREAD__
constexpr bool can_limit_files = false;  // the sanitizer ends a process with `ulimit -f`
#else
constexpr bool can_limit_files = true;
#endif

/// Gives a program that has just started the lowest priority, if SONOPOSE_FAULT_NICE=1.
void make_nice(const Process& process) {
  constexpr int lowest = 19;
  if (std::getenv("SONOPOSE_FAULT_NICE") == nullptr) return;
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(process.pid()), lowest);
}

bool is_crowded() {
  return std::getenv("SONOPOSE_FAULT_CROWD") != nullptr;
}

}  // namespace

BeaconAddress Cast::last_address() {
  constexpr BeaconAddress beacons = 20;
  return is_crowded() ? first_address + beacons - 1 : first_address + 1;
}

std::string faketime_library() {
  for (const auto& folder : std::filesystem::directory_iterator("/usr/lib")) {
    const auto file = folder.path() / "faketime/libfaketimeMT.so.1";
    if (std::filesystem::exists(file)) return file.string();
  }
  return {};
}

// Line

FeedLine::FeedLine(Line kind, std::filesystem::path device) : device_(std::move(device)) {
  if (kind == Line::udp) {
    sender_.emplace();
  } else {
    plug();
  }
}

void FeedLine::send(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (sender_) sender_->send(bytes);
  if (terminal_) terminal_->send_what_fits(bytes);
}

void FeedLine::unplug() {
  const std::lock_guard lock(mutex_);
  terminal_.reset();
  std::filesystem::remove(device_);
}

void FeedLine::plug() {
  const std::lock_guard lock(mutex_);
  terminal_.emplace();
  std::filesystem::create_symlink(terminal_->device(), device_);
}

Arguments FeedLine::bridge_options() const {
  if (sender_) return {"--source", "udp", "--listen", sender_->endpoint()};
  return {"--source", "serial", "--device", device_.string()};
}

// Processes

Cast::Cast(const test::Bus& bus, const Plan& plan)
    : bus_(bus),
      plan_(plan),
      line_(plan.line, folder_ / "ttyACM0"),
      feed_(plan.line == Line::udp ? test::BeaconFeed::Format::datagrams : test::BeaconFeed::Format::frames,
            imu_rate_hz, [this](std::span<const std::uint8_t> bytes) { line_.send(bytes); }) {
  step_clock(0);
  if (plan.disk == Disk::slow) {
    const std::string pipe = (folder_ / "capture").string();
    ::mkfifo(pipe.c_str(), 0600);
    pipe_ = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
    ::fcntl(pipe_, F_SETPIPE_SZ, 4096);
    drain_ = std::jthread([this](const std::stop_token& stop) { drain(stop); });
  }
  for (BeaconAddress address = first_address; address <= last_address(); ++address) feed_.add(address);
  for (int i = 0; i <= plan.fusions; ++i) start(all_roles.at(static_cast<std::size_t>(i)));
  for (int i = 0; i <= plan.fusions; ++i) wait_until_ready(all_roles.at(static_cast<std::size_t>(i)));
  if (is_crowded()) start_consumers();
}

Cast::~Cast() {
  for (auto& entry : restarts_) entry.second.join();
  drain_ = {};
  if (pipe_ >= 0) ::close(pipe_);
}

/// Drains the slow disk at 2 kB/s until the stop is requested.
void Cast::drain(const std::stop_token& stop) const {
  std::array<char, 200> bytes{};
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (::read(pipe_, bytes.data(), bytes.size()) < 0) continue;
  }
}

Arguments Cast::arguments_of(Role role) {
  Arguments arguments{"--domain", std::to_string(bus_.domain_id())};
  if (role != Role::bridge) {
    arguments.insert(arguments.end(),
                     {"--standby-strength", std::to_string(strength_of(role)), "--warm-up", "0.2"});
    return arguments;
  }
  const Arguments line = line_.bridge_options();
  arguments.insert(arguments.end(), line.begin(), line.end());
  if (plan_.disk == Disk::full) {
    const std::string name = "record-" + std::to_string(recordings_++);
    arguments.insert(arguments.end(), {"--record", (folder_ / name.c_str()).string()});
  } else if (plan_.disk == Disk::slow) {
    arguments.insert(arguments.end(), {"--capture", (folder_ / "capture").string()});
  }
  return arguments;
}

test::Environment Cast::environment_of(Role role) const {
  test::Environment environment;
  if (plan_.loss && plan_.loss->role == role) {
    environment["CYCLONEDDS_URI"] = fmt::format(
        "<CycloneDDS><Domain><Internal><Test><XmitLossiness>{}</XmitLossiness></Test></Internal>"
        "</Domain></CycloneDDS>",
        plan_.loss->permille);
  }
  if (stepped_clock(plan_) == role) {
    environment["LD_PRELOAD"] = faketime_library();
    environment["FAKETIME_TIMESTAMP_FILE"] = (folder_ / "clock").string();
    environment["FAKETIME_NO_CACHE"] = "1";
    environment["FAKETIME_DONT_FAKE_MONOTONIC"] = "1";
  }
  return environment;
}

/// Sets the clock of the process that reads this file.
void Cast::step_clock(TimeNs offset_ns) const {
  test::write_text(folder_ / "clock.new", fmt::format("{:+.3f}\n", seconds_between(0, offset_ns)));
  std::filesystem::rename(folder_ / "clock.new", folder_ / "clock");
}

void Cast::start(Role role) {
  const Arguments arguments = arguments_of(role);
  const test::Environment environment = environment_of(role);
  const std::string program = role == Role::bridge ? SONOPOSE_TEST_BRIDGE : SONOPOSE_TEST_FUSION;
  processes_[role] = role == Role::bridge && plan_.disk == Disk::full && can_limit_files
                         ? limited("ulimit -f 64", program, arguments, environment)
                         : std::make_unique<Process>(program, arguments, environment);
  make_nice(*processes_.at(role));
}

void Cast::start_consumers() {
  const auto start = [&](const std::string& program, const Arguments& more) {
    Arguments arguments{"--domain", std::to_string(bus_.domain_id())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    consumers_[program] = std::make_unique<Process>(program, arguments);
    make_nice(*consumers_.at(program));
  };
  start(SONOPOSE_TEST_MONITOR, {"--json"});
  start(SONOPOSE_TEST_RECORD, {(folder_ / "recorded.mcap").string()});
  start(SONOPOSE_TEST_ROS2, {});
#ifdef SONOPOSE_TEST_WEB
  start(SONOPOSE_TEST_WEB, {"--listen", "127.0.0.1:0"});
#endif
}

void Cast::wait_until_ready(Role role) {
  // A serial bridge waits for its device or reads it.
  const char* const of_bridge = plan_.line == Line::serial ? " baud" : "publishing from";
  const bool ready =
      processes_.at(role)->wait_for_line(Stream::error, role == Role::bridge ? of_bridge : "serving");
  const std::lock_guard lock(mutex_);
  if (!ready)
    failures_.push_back(text_of(role) + " did not start: " + processes_.at(role)->text(Stream::error));
  lives_.push_back({role, {clocks::steady_now()}});
}

void Cast::join_restart(Role role) {
  const auto found = restarts_.find(role);
  if (found == restarts_.end()) return;
  found->second.join();
  restarts_.erase(found);
}

/// Ends a process by a signal. Records a failure if it was already dead or ended with a wrong code.
void Cast::take_out(Role role, int signal) {
  Process& process = *processes_.at(role);
  const bool was_alive = !process.wait_for_exit(std::chrono::milliseconds(0));
  {
    const std::lock_guard lock(mutex_);
    for (Life& life : lives_) {
      if (life.role == role) life.interval.until = std::min(life.interval.until, clocks::steady_now());
    }
  }
  const auto ending = process.end_by(signal);
  const bool may_lack = role == Role::bridge && plan_.disk != Disk::none;
  const bool good = was_alive && (signal == SIGKILL || ending.code == 0 || (may_lack && ending.code == 1));
  if (good) return;
  const std::lock_guard lock(mutex_);
  failures_.push_back(fmt::format("{} ended with {}: {}", text_of(role),
                                  ending.code ? std::to_string(*ending.code) : "no exit",
                                  process.text(Stream::error)));
}

void Cast::start_without_descriptors(std::uint32_t count) {
  const auto process = limited("ulimit -n " + std::to_string(count), SONOPOSE_TEST_FUSION,
                               {"--domain", std::to_string(bus_.domain_id())}, {});
  const auto code = process->wait_for_exit();
  const std::string text = process->text(Stream::error);
  if (code && *code > 0 && text.find("file descriptors are allowed") != std::string::npos) return;
  const std::lock_guard lock(mutex_);
  failures_.push_back(fmt::format("a fusion with {} descriptors ended with {}: {}", count,
                                  code ? std::to_string(*code) : "no exit", text));
}

// Playing the plan

void Cast::begin(const Step& step) {
  switch (step.fault) {
    case Fault::kill:
    case Fault::terminate:
      join_restart(step.target);
      take_out(step.target, step.fault == Fault::kill ? SIGKILL : SIGTERM);
      break;
    case Fault::stop:
      join_restart(step.target);
      processes_.at(step.target)->send(SIGSTOP);
      break;
    case Fault::clock_step:
      step_clock(step.amount_ns);
      break;
    case Fault::few_descriptors:
      start_without_descriptors(step.count);
      break;
    case Fault::delay:
      feed_.delay(step.amount_ns);
      break;
    case Fault::reorder:
      feed_.reorder(step.amount_ns);
      break;
    case Fault::garbage:
      feed_.send_garbage(step.count, plan_.seed);
      break;
    case Fault::unplug:
      line_.unplug();
      break;
  }
}

void Cast::end(const Step& step) {
  switch (step.fault) {
    case Fault::kill:
    case Fault::terminate:
      start(step.target);
      break;
    case Fault::stop:
      processes_.at(step.target)->send(SIGCONT);
      break;
    case Fault::delay:
      feed_.delay(0);
      break;
    case Fault::reorder:
      feed_.reorder(0);
      break;
    case Fault::garbage:
      feed_.send_garbage(step.count, plan_.seed + 1);
      break;
    case Fault::unplug:
      line_.plug();
      break;
    case Fault::clock_step:
    case Fault::few_descriptors:
      break;
  }
}

void Cast::play() {
  struct Moment {
    TimeNs at_ns;
    std::size_t step;
    bool begins;
  };
  std::vector<Moment> moments;
  for (std::size_t i = 0; i < plan_.steps.size(); ++i) {
    const Step& step = plan_.steps[i];
    episodes_.push_back({step, {SteadyTime::max()}});
    moments.push_back({step.at_ns, i, true});
    moments.push_back({step.at_ns + step.for_ns, i, false});
  }
  std::stable_sort(moments.begin(), moments.end(),
                   [](const Moment& a, const Moment& b) { return a.at_ns < b.at_ns; });
  const SteadyTime start_time = clocks::steady_now();
  for (const Moment& moment : moments) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(start_time + moment.at_ns - clocks::steady_now()));
    Episode& episode = episodes_[moment.step];
    const Step& step = episode.step;
    if (moment.begins) {
      episode.interval.from = clocks::steady_now();
      begin(step);
      continue;
    }
    const bool restarts = step.fault == Fault::kill || step.fault == Fault::terminate;
    if (!restarts) episode.interval.until = clocks::steady_now();  // before the process continues
    end(step);
    if (!restarts) continue;
    restarts_[step.target] = std::thread([this, &episode] {
      wait_until_ready(episode.step.target);
      episode.interval.until = clocks::steady_now();
    });
  }
  for (const Role role : all_roles) join_restart(role);
}

std::vector<std::string> Cast::finish() {
  for (const auto& [program, process] : consumers_) {
    if (!process->wait_for_exit(std::chrono::milliseconds(0)) && process->end_by(SIGTERM).code == 0) continue;
    failures_.push_back(program + " ended wrongly: " + process->text(Stream::error));
  }
  for (const auto& entry : processes_) take_out(entry.first, SIGTERM);
  return failures_;
}

}  // namespace sonopose::faults
