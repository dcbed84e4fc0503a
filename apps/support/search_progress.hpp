#pragma once
// Shows the progress of a search, and handles Ctrl-C.

#include "logging/log.hpp"
#include "progress.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <csignal>
#include <cstdint>

namespace sonopose::apps {

inline volatile std::sig_atomic_t interrupted = 0;

/// Makes the first Ctrl-C set `interrupted`; the second one ends the program.
inline void listen_for_interrupt() {
  std::signal(SIGINT, [](int signal) {
    interrupted = 1;
    std::signal(signal, SIG_DFL);
  });
}

/// Reports on standard error. On a terminal, the last line is the progress.
class SearchProgress {
public:
  explicit SearchProgress(int rounds) : rounds_(rounds) {}

  void on_round(int round) {
    progress_.at(static_cast<double>(round) / rounds_,
                 fmt::format("round {} of {}, best {:.3f} cm", round + 1, rounds_, 100.0 * best_m_));
  }
  void on_better(int round, double best_m) {
    best_m_ = best_m;
    progress_.clear();
    logging::info(fmt::format("round {}: {:.3f} cm", round + 1, 100.0 * best_m));
  }
  void on_interrupt(int round) {
    progress_.clear();
    logging::info(fmt::format("interrupted after {} of {}: the best so far follows",
                              text::count_text(static_cast<std::uint64_t>(round), "round"), rounds_));
  }
  void start_at(double start_m) { best_m_ = start_m; }

private:
  int rounds_;
  Progress progress_;
  double best_m_ = 0;
};

}  // namespace sonopose::apps
