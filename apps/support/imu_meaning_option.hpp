#pragma once
// The words of --imu-meaning.

#include "choice.hpp"
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <string>

namespace sonopose::apps {

inline Words<std::optional<ImuMeaning>> imu_meaning_choices() {
  Words<std::optional<ImuMeaning>> words;
  for (std::size_t i = 0; i < imu_meaning_words.size(); ++i) {
    words.emplace_back(std::string(imu_meaning_words[i]), static_cast<ImuMeaning>(i));
  }
  return words;
}

}  // namespace sonopose::apps
