// Preload (LD_PRELOAD) that makes discovery messages announce types of a kind that no version of the XTypes
// specification defines.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <dlfcn.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <vector>

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint16_t pid_type_information = 0x0075;
constexpr std::size_t parameter_header_size = 4;  // id and length, 16 bits each
constexpr std::size_t min_type_information_size = 40;
constexpr std::uint8_t ek_minimal = 0xf1;
constexpr std::uint8_t ek_complete = 0xf2;
constexpr std::uint8_t unknown_kind = 0x99;

std::size_t little_endian_16(const Bytes& bytes, std::size_t at) {
  return bytes[at] | static_cast<std::size_t>(bytes[at + 1]) << 8U;
}

/// Changes every byte of the parameter that may be the kind of a type identifier.
void change_kinds(Bytes& packet) {
  for (std::size_t at = 0; at + parameter_header_size <= packet.size(); at += parameter_header_size) {
    if (little_endian_16(packet, at) != pid_type_information) continue;
    const std::size_t size = little_endian_16(packet, at + 2);
    const std::size_t begin = at + parameter_header_size;
    if (size < min_type_information_size || size > packet.size() - begin) continue;
    const auto first = packet.begin() + static_cast<std::ptrdiff_t>(begin);
    std::replace_if(
        first, first + static_cast<std::ptrdiff_t>(size),
        [](std::uint8_t byte) { return byte == ek_minimal || byte == ek_complete; }, unknown_kind);
  }
}

}  // namespace

// Replaces the C library's sendmsg.
extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  static const auto send = reinterpret_cast<decltype(&::sendmsg)>(::dlsym(RTLD_NEXT, "sendmsg"));
  Bytes packet;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) {
    const iovec& part = message->msg_iov[i];
    const auto* const bytes = static_cast<const std::uint8_t*>(part.iov_base);
    packet.insert(packet.end(), bytes, bytes + part.iov_len);
  }
  change_kinds(packet);
  iovec whole{.iov_base = packet.data(), .iov_len = packet.size()};
  msghdr changed = *message;
  changed.msg_iov = &whole;
  changed.msg_iovlen = 1;
  return send(socket, &changed, flags);
}
