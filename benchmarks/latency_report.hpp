#pragma once
// What the latency benchmark prints.

#include "chains.hpp"

#include <string>
#include <vector>

namespace sonopose::benchmarks {

/// The rounds of one chain at one rate.
struct ChainResult {
  std::string name;
  std::vector<Round> rounds;
  Round pending;  ///< of the round that is not over yet for all chains
};

/// Every chain has as many rounds as the others. The first three are: udp, bare, sonopose.
using Results = std::vector<ChainResult>;

/// Percentiles pooled over the rounds, ratios as medians of the rounds' own ratios with the interval that
/// holds their median with 95 %, and whether the bars are met.
void print_report(double rate_hz, double round_s, const Results& results);

}  // namespace sonopose::benchmarks
