#pragma once
/// \file
/// When the messages of a chunk arrived.

#include <sonopose/samples/time.hpp>

namespace sonopose::recorder {

/// By the steady clock: the log times follow the host's clock, which may be set at any moment.
struct Taken {
  SteadyTime begin;
  SteadyTime end;
};

}  // namespace sonopose::recorder
