#pragma once
/// \file
/// A signal of the operating system as a trigger.

#include "recorder/trigger.hpp"

namespace sonopose::recorder {

/// Fires the trigger, which must outlive it, on a signal. One object at a time.
class SignalTrigger {
public:
  /// Throws std::system_error.
  SignalTrigger(int signal, Trigger& trigger);
  SignalTrigger(const SignalTrigger&) = delete;
  SignalTrigger& operator=(const SignalTrigger&) = delete;
  /// Disables the signal.
  ~SignalTrigger();

private:
  int signal_;
};

}  // namespace sonopose::recorder
