#pragma once
/// \file
/// A signal of the operating system as a trigger.

#include "recorder/trigger.hpp"

namespace sonopose::recorder {

/// While it exists, the signal fires the trigger, which must outlive it. One at a time.
class SignalTrigger {
public:
  /// Throws std::system_error.
  SignalTrigger(int signal, Trigger& trigger);
  SignalTrigger(const SignalTrigger&) = delete;
  SignalTrigger& operator=(const SignalTrigger&) = delete;
  SignalTrigger(SignalTrigger&&) = delete;
  SignalTrigger& operator=(SignalTrigger&&) = delete;
  /// From now on the signal has no effect.
  ~SignalTrigger();

private:
  int signal_;
};

}  // namespace sonopose::recorder
