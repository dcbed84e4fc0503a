#pragma once
// Prints the results of the latency benchmark.

#include "chains.hpp"

#include <string>
#include <vector>

namespace sonopose::benchmarks {

/// The rounds of one chain at one rate.
struct ChainResult {
  std::string name;
  std::vector<Round> rounds;
  Round pending;  ///< result of a round that not all chains have completed
};

/// Results of the chains, with the same number of rounds. The first ones are udp, bare, bare again,
/// documented and kalman.
using Results = std::vector<ChainResult>;

/// Prints percentiles pooled over the rounds, the median of the ratios per round with its 95 % confidence
/// interval, and the verdict on the limits. If all are secured, the limit is 1.25 times the secured bare
/// chain.
void print_report(double rate_hz, double round_s, const Results& results, bool is_secured);

}  // namespace sonopose::benchmarks
