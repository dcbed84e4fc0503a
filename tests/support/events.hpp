#pragma once
/// \file
/// The samples of one kind among events.

#include <sonopose/samples/samples.hpp>

#include <variant>
#include <vector>

namespace sonopose::test {

/// Pointers to the samples of one kind, to read or change them in place.
template <class Sample>
auto each(auto& events) {
  std::vector<decltype(std::get_if<Sample>(&events.front()))> found;
  for (auto& event : events) {
    if (auto* const sample = std::get_if<Sample>(&event)) found.push_back(sample);
  }
  return found;
}

/// Copies of the samples of one kind.
template <class Sample>
std::vector<Sample> samples_of(const std::vector<Event>& events) {
  std::vector<Sample> found;
  for (const Sample* sample : each<Sample>(events)) found.push_back(*sample);
  return found;
}

}  // namespace sonopose::test
