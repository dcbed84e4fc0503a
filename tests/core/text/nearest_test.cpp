#include <sonopose/text/nearest.hpp>

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace nearest_test {

using sonopose::text::nearest;
using sonopose::text::suggestion;

const std::vector<std::string> known{"--duration", "--max-size", "drift.decay_rate_hz", "trust.sigma_m",
                                     "heading.mount_offset_deg"};

TEST_CASE("a misspelt word is answered by the known one") {
  CHECK(nearest("--duratoin", known) == "--duration");
  CHECK(nearest("--max", known) == "--max-size");
  CHECK(nearest("trust.sigmam", known) == "trust.sigma_m");
  CHECK(nearest("drift.decay_rate", known) == "drift.decay_rate_hz");
  CHECK(suggestion("--duratoin", known) == "; did you mean --duration?");
}

TEST_CASE("a word that is near none is answered by none") {
  for (const char* const word :
       {"", "x", "colour", "trust.colour", "heading.temperature_limit", "a.b.c", "foo"}) {
    CAPTURE(word);
    CHECK_FALSE(nearest(word, known));
    CHECK(suggestion(word, known).empty());
  }
}

}  // namespace nearest_test
