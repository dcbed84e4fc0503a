#pragma once
/// \file
/// Times at which the messages of a chunk arrived.

#include <sonopose/samples/time.hpp>

namespace sonopose::recorder {

/// Steady times: log times follow the host's clock, which may be set at any moment.
struct ArrivalSpan {
  SteadyTime begin;
  SteadyTime end;
};

}  // namespace sonopose::recorder
