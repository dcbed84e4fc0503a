#include "dds/binding/refusals.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

namespace refusals_test {

using sonopose::dds::Refusals;

// The messages are those of Cyclone DDS 0.10.2.

SCENARIO("a refused certificate is named once, with the reason in plain words") {
  Refusals refusals;
  const std::string message =
      "Begin handshake reply failed: Certificate not valid: error: certificate signature failure; subject: "
      "/CN=\\/fusion(code: 200)";
  const auto first = refusals.on_message(message);
  CHECK(first.is_about_refusal);
  CHECK(first.text ==
        "security: refused a process (certificate /CN=/fusion): its certificate is of another key store");
  const auto repeated = refusals.on_message(message);
  CHECK(repeated.is_about_refusal);
  CHECK(repeated.text.empty());
  CHECK(refusals.peers().size() == 1);
}

SCENARIO("a peer with Fast DDS that begins the handshake is reported with the remedy") {
  Refusals refusals;
  const std::string message =
      "Begin handshake reply failed: Failed to convert octet sequence to ASN1 integer: "
      "error:0680008E:asn1 encoding routines::not enough data(code: 200)";
  CHECK(refusals.on_message(message).text ==
        "security: refused a process: it probably has Fast DDS, and began the handshake; make its enclave "
        "with --fastdds");
  CHECK(refusals.on_message(message).text.empty());
  THEN("another reason without a name is reported too, once") {
    const std::string other = "Process handshake failed: no memory(code: 105)";
    CHECK_THAT(refusals.on_message(other).text, Catch::Contains("no memory"));
    CHECK(refusals.on_message(other).text.empty());
    CHECK(refusals.on_message(message).text.empty());
    CHECK(refusals.peers().size() == 2);
  }
}

SCENARIO("another governance is reported when the process is refused again") {
  Refusals refusals;
  const std::string message = "Remote secure participant 83f0a0a6:36b864f1:34fcf8:1c1 not allowed";
  CHECK(refusals.on_message(message).text.empty());  // usual while both sides start
  CHECK_THAT(refusals.on_message(message).text, Catch::Contains("83f0a0a636b864f10034fcf8"));
  CHECK(refusals.peers().front().key_prefix == "83f0a0a636b864f10034fcf8");
}

SCENARIO("attributes that contradict each other are another governance, whatever they are of") {
  const std::string key = "83f0a0a6:36b864f1:34fcf8:";
  const std::string ours = " 110a:b3:1:1c1 security_attributes mismatch: 0x80000007.0x80000000 - 0x8.0x8";
  for (const auto& [begin, end] : {std::pair("match remote_participant ", "1c1 with participant"),
                                   std::pair("match_remote_writer ", "302 with reader"),
                                   std::pair("match_remote_reader ", "407 with writer")}) {
    std::string message = begin;
    message.append(key).append(end).append(ours);
    CAPTURE(message);
    Refusals refusals;
    CHECK_THAT(refusals.on_message(message).text,
               Catch::Contains("83f0a0a636b864f10034fcf8") && Catch::Contains("its governance differs"));
    CHECK(refusals.on_message(message).is_about_refusal);
    CHECK(refusals.peers().size() == 1);
  }
}

SCENARIO("more processes are refused than are remembered") {
  const auto message_of = [](int process) {
    return "Remote secure participant " + std::to_string(process) + ":1:1:1c1 not allowed";
  };
  Refusals refusals;
  for (int i = 0; i < 100; ++i) CHECK(refusals.on_message(message_of(i)).text.empty());
  THEN("the latest is judged at its second refusal, the oldest is forgotten") {
    CHECK(refusals.on_message(message_of(0)).text.empty());
    CHECK_THAT(refusals.on_message(message_of(99)).text, Catch::Contains("its governance differs"));
    CHECK(refusals.peers().size() == 1);
  }
}

SCENARIO("other messages stay as they are, and a forger of refusals fills no memory") {
  Refusals refusals;
  CHECK_FALSE(refusals.on_message("selected interface \"lo\" is not multicast-capable").is_about_refusal);
  int named = 0;
  int summaries = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string text =
        refusals
            .on_message(
                "Process handshake failed: Certificate not valid: error: certificate revoked; "
                "subject: /CN=\\/" +
                std::to_string(i) + "(code: 200)")
            .text;
    if (text.find("more processes are refused") != text.npos) {
      ++summaries;
    } else if (!text.empty()) {
      ++named;
    }
  }
  CHECK(named == 64);
  CHECK(summaries == 1);
  CHECK(refusals.peers().size() == 64);
}

}  // namespace refusals_test
