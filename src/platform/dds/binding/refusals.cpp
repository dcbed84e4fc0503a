#include "dds/binding/refusals.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace sonopose::dds {
namespace {

constexpr std::size_t max_peers = 64;
constexpr const char* other_governance =
    "its governance differs: another protection, or security of another kind";

/// Converts "110a:b3:1:1c1" to the first 24 hexadecimal digits of the key.
std::string key_prefix_of(std::string_view guid) {
  std::string prefix;
  for (int part = 0; part < 3; ++part) {
    const std::string_view digits = guid.substr(0, guid.find(':'));
    if (digits.size() < 8) prefix.append(8 - digits.size(), '0');
    prefix += digits;
    guid.remove_prefix(std::min(guid.size(), digits.size() + 1));
  }
  return prefix;
}

/// Returns the GUID that follows a word; empty if there is none.
std::string_view guid_after(std::string_view message, std::string_view word) {
  const std::size_t at = message.find(word);
  if (at == message.npos) return {};
  message.remove_prefix(at + word.size());
  return message.substr(0, message.find_first_not_of("0123456789abcdef:"));
}

/// Returns a reason of OpenSSL or of Cyclone DDS in our words.
std::string plain(std::string_view reason) {
  struct Words {
    std::string_view part;
    const char* plain;
  };
  constexpr std::array all{
      Words{"PKCS7", "its permissions are not signed by our permissions authority"},
      Words{"valid grant", "its permissions are those of another"},
      Words{"Permissions validity", "its permissions have expired"},
      Words{"self-signed", "its certificate is of another key store"},
      Words{"issuer certificate", "its certificate is of another key store"},
      Words{"signature failure", "its certificate is of another key store"},
      Words{"certificate has expired", "its certificate has expired"},
      Words{"Certificate expired", "its certificate has expired"},
      Words{"certificate revoked", "its certificate is revoked"},
      Words{"ASN1 integer",
            "it probably has Fast DDS, and began the handshake; make its enclave with --fastdds"},
  };
  const auto* const found =
      std::ranges::find_if(all, [&](const Words& words) { return reason.find(words.part) != reason.npos; });
  return found == all.end() ? std::string(reason) : found->plain;
}

/// Returns "/CN=/bridge" from "…; subject: /CN=\\/bridge(code: 200)".
std::string subject_in(std::string_view message) {
  const std::string_view mark = "subject: ";
  const std::size_t at = message.find(mark);
  if (at == message.npos) return {};
  std::string subject(message.substr(at + mark.size(), message.rfind("(code") - at - mark.size()));
  std::erase(subject, '\\');
  return subject;
}

}  // namespace

Refusals::Verdict Refusals::on_message(std::string_view message) {
  const std::lock_guard lock(mutex_);
  for (const std::string_view kind : {"Non secure remote writer ", "Non secure remote reader "}) {
    const auto guid = guid_after(message, kind);
    if (!guid.empty()) return refuse({key_prefix_of(guid), {}, "it has no certificate"});
  }
  for (const std::string_view kind :
       {"match remote_participant ", "match_remote_writer ", "match_remote_reader "}) {
    const auto guid = guid_after(message, kind);
    if (!guid.empty()) return refuse({key_prefix_of(guid), {}, other_governance});
  }
  if (const auto guid = guid_after(message, "Remote secure participant "); !guid.empty()) {
    // At the start of this process, it refuses all; then only those with another governance, again and again.
    const std::string prefix = key_prefix_of(guid);
    if (std::ranges::find(suspects_, prefix) == suspects_.end()) {
      suspects_.push_back(prefix);
      if (suspects_.size() > max_peers) suspects_.pop_front();
      return {.is_about_refusal = true, .text = {}};
    }
    return refuse({prefix, {}, other_governance});
  }
  // A step that failed names the certificate, but not the process.
  for (const std::string_view step : {"Validate remote identity failed: ", "Begin handshake request failed: ",
                                      "Begin handshake reply failed: ", "Process handshake failed: "}) {
    if (message.starts_with(step)) return refuse({{}, subject_in(message), plain(message)});
  }
  if (message.starts_with("handshake (") && message.find(" failed: ") != message.npos) {
    return refuse({key_prefix_of(guid_after(message, "rguid=")), {}, "the handshake failed, on either side"});
  }
  if (const auto guid = guid_after(message, "Could not get remote participant "); !guid.empty()) {
    return refuse({key_prefix_of(guid), {}, plain(message)});
  }
  return {};
}

Refusals::Verdict Refusals::refuse(RefusedPeer peer) {
  Verdict verdict{.is_about_refusal = true, .text = {}};
  const bool is_named = !peer.key_prefix.empty() || !peer.subject.empty();
  const std::string name = is_named ? peer.key_prefix + peer.subject : peer.reason;
  if (known_.contains(name)) return verdict;
  if (known_.size() >= max_peers) {
    if (!std::exchange(is_full_, true)) {
      verdict.text =
          "security: more processes are refused; the first " + std::to_string(max_peers) + " are named";
    }
    return verdict;
  }
  known_.insert(name);
  verdict.text = "security: refused " + text_of(peer);
  peers_.push_back(std::move(peer));
  return verdict;
}

std::vector<RefusedPeer> Refusals::peers() const {
  const std::lock_guard lock(mutex_);
  return peers_;
}

std::string text_of(const RefusedPeer& peer) {
  const std::string who = !peer.subject.empty()      ? " (certificate " + peer.subject + ")"
                          : !peer.key_prefix.empty() ? " (key " + peer.key_prefix + ")"
                                                     : "";
  return "a process" + who + ": " + peer.reason;
}

}  // namespace sonopose::dds
