#include "recorder/signal_trigger.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace sonopose::recorder {
namespace {

// Signal handlers may use only lock-free atomics.
std::atomic<Trigger*> signalled{nullptr};
static_assert(std::atomic<Trigger*>::is_always_lock_free && std::atomic<TriggerCause>::is_always_lock_free);

extern "C" void sonopose_on_trigger_signal(int /*signal*/) {
  if (Trigger* const trigger = signalled.load(); trigger != nullptr) trigger->fire(TriggerCause::signal);
}

}  // namespace

SignalTrigger::SignalTrigger(int signal, Trigger& trigger) : signal_(signal) {
  signalled.store(&trigger);
  struct sigaction action {};
  action.sa_handler = sonopose_on_trigger_signal;
  action.sa_flags = SA_RESTART;
  if (::sigaction(signal, &action, nullptr) != 0) {
    throw std::system_error(errno, std::generic_category(), "sigaction");
  }
}

SignalTrigger::~SignalTrigger() {
  std::signal(signal_, SIG_IGN);
  signalled.store(nullptr);
}

}  // namespace sonopose::recorder
