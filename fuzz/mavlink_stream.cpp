// Decodes the bytes of a MAVLink line, whole and byte by byte.

#include "mavlink/messages.hpp"
#include "support.hpp"

#include <span>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  mavlink::Decoder whole;
  std::vector<std::vector<std::uint8_t>> frames;
  whole.feed(bytes, [&](const mavlink::Frame& frame) {
    promise(frame.size <= mavlink::max_payload, "a payload fits into its frame");
    promise(mavlink::checksum_seed(frame.message_id).has_value(), "only known messages are passed on");
    frames.push_back(encode(frame, 0));
    static_cast<void>(mavlink::autopilot_of(frame));
    static_cast<void>(mavlink::timesync_answer(frame, {}, 1));
    mavlink::Decoder again;
    again.feed(frames.back(), [&](const mavlink::Frame& second) {
      promise(second.payload == frame.payload && second.sender == frame.sender,
              "an encoded frame is decoded again");
    });
    promise(again.counters().frames == 1, "an encoded frame is a whole one");
  });
  mavlink::Decoder piecewise;
  std::size_t count = 0;
  for (const std::uint8_t& byte : bytes) {
    piecewise.feed({&byte, 1}, [&](const mavlink::Frame& frame) {
      promise(count < frames.size() && encode(frame, 0) == frames[count], "pieces give the same frames");
      ++count;
    });
  }
  promise(count == frames.size(), "pieces give as many frames");
  return 0;
}
