#include "faults/stall_watch.hpp"

#include "clocks/clocks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <unistd.h>
#include <utility>

namespace sonopose::faults {
namespace {

namespace fs = std::filesystem;

constexpr TimeNs min_ns = 3'000'000;  ///< shortest recorded stall

/// Folders of the threads of this process and of its children.
std::vector<fs::path> thread_folders() {
  std::vector<fs::path> folders;
  std::set<std::string> children;
  std::error_code ended;
  for (const auto& thread : fs::directory_iterator("/proc/self/task", ended)) {
    folders.push_back(thread.path());
    std::ifstream list(thread.path() / "children");
    for (std::string child; list >> child;) children.insert(child);
  }
  for (const std::string& child : children) {
    for (const auto& thread : fs::directory_iterator("/proc/" + child + "/task", ended)) {
      folders.push_back(thread.path());
    }
  }
  return folders;
}

/// Nanoseconds spent waiting: the second number in the file. Empty if the thread has ended.
std::optional<std::uint64_t> waited_ns(int file) {
  std::array<char, 100> text{};
  if (::pread(file, text.data(), text.size() - 1, 0) <= 0) return std::nullopt;
  char* rest = nullptr;
  std::strtoull(text.data(), &rest, 10);
  return std::strtoull(rest, nullptr, 10);
}

}  // namespace

StallWatch::StallWatch() : thread_([this](const std::stop_token& stop) { watch(stop); }) {}

StallWatch::~StallWatch() {
  thread_ = {};
  for (const auto& entry : tasks_) ::close(entry.second.file);
}

std::vector<Interval> StallWatch::stalls() const {
  const std::lock_guard lock(mutex_);
  return stalls_;
}

void StallWatch::watch(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds period{10};
  constexpr int rounds_per_search = 10;
  for (int round = 0; !stop.stop_requested(); ++round) {
    if (round % rounds_per_search == 0) find_tasks();
    const SteadyTime now = clocks::steady_now();
    sample(now);
    std::this_thread::sleep_for(period);
    // The kernel counts no wait while the virtual machine itself is suspended.
    const SteadyTime due = now + TimeNs{std::chrono::nanoseconds(period).count()};
    if (clocks::steady_now() - due >= min_ns) add({due, clocks::steady_now()});
  }
}

void StallWatch::find_tasks() {
  for (const fs::path& folder : thread_folders()) {
    const std::string name = folder / "schedstat";
    if (tasks_.contains(name)) continue;
    const int file = ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
    if (file >= 0) tasks_.emplace(name, Task{file, waited_ns(file).value_or(0)});
  }
}

void StallWatch::add(const Interval& stall) {
  const std::lock_guard lock(mutex_);
  stalls_.push_back(stall);
}

void StallWatch::sample(SteadyTime now) {
  for (auto entry = tasks_.begin(); entry != tasks_.end();) {
    Task& task = entry->second;
    const auto waited = waited_ns(task.file);
    if (!waited) {
      ::close(task.file);
      entry = tasks_.erase(entry);
      continue;
    }
    const auto more_ns = static_cast<TimeNs>(*waited - std::exchange(task.waited_ns, *waited));
    if (more_ns >= min_ns) add({now - more_ns, now});
    ++entry;
  }
}

std::vector<Interval> merged(std::vector<Interval> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.from < b.from; });
  std::vector<Interval> disjoint;
  for (const Interval& interval : intervals) {
    if (!disjoint.empty() && interval.from <= disjoint.back().until) {
      disjoint.back().until = std::max(disjoint.back().until, interval.until);
    } else {
      disjoint.push_back(interval);
    }
  }
  return disjoint;
}

TimeNs covered_ns(const std::vector<Interval>& disjoint, SteadyTime from, SteadyTime until) {
  TimeNs sum_ns = 0;
  for (const Interval& interval : disjoint) {
    sum_ns += std::max<TimeNs>(0, std::min(interval.until, until) - std::max(interval.from, from));
  }
  return sum_ns;
}

}  // namespace sonopose::faults
