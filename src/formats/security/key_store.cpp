#include "security/key_store.hpp"

#include "files/descriptor.hpp"
#include "files/replacement.hpp"
#include "security/authority.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/revocation.hpp"
#include "security/signed_document.hpp"
#include "security/store_revocations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <sstream>
#include <string_view>
#include <sys/file.h>
#include <system_error>
#include <utility>

namespace sonopose::security {
namespace {

namespace fs = std::filesystem;

constexpr const char* identity_authority = "identity_ca";
constexpr const char* permissions_authority = "permissions_ca";
constexpr std::int64_t authority_days = 3653;  // ten years, as SROS2

fs::path certificate_path(const fs::path& store, const char* authority) {
  return store / "public" / (std::string(authority) + ".cert.pem");
}

fs::path key_path(const fs::path& store, const char* authority) {
  return store / "private" / (std::string(authority) + ".key.pem");
}

/// The certificates that the identity authority issued: lines of a serial number and the enclave.
fs::path issued_path(const fs::path& store) {
  return store / "private" / "issued.txt";
}

void write_pair(const fs::path& certificate, const fs::path& key, const KeyPair& pair) {
  files::write_private(key, pair.key_pem);
  files::write_whole(certificate, pair.certificate_pem);
}

/// Links an enclave's file to one of the whole store, as SROS2 does: copy enclaves with `cp -rL`.
void link(const fs::path& target, const fs::path& link) {
  std::error_code error;
  const fs::path place = fs::relative(target, link.parent_path());
  if (fs::read_symlink(link, error) == place) return;
  fs::remove(link, error);
  fs::create_symlink(place, link, error);
  if (error) throw SecurityError(fmt::format("{}: {}", link.string(), error.message()));
}

void make_folder(const fs::path& folder, fs::perms mode) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) fs::permissions(folder, mode, error);
  if (error) throw SecurityError(fmt::format("{}: {}", folder.string(), error.message()));
}

/// Keeps other processes from changing a store as long as the result lives; waits for those that do.
files::Descriptor locked(const fs::path& store) {
  files::Descriptor folder(::open(store.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.number() < 0 || ::flock(folder.number(), LOCK_EX) != 0) {
    throw SecurityError(
        fmt::format("{}: cannot be locked: {}", store.string(), std::generic_category().message(errno)));
  }
  return folder;
}

/// Every file of an enclave.
constexpr std::array enclave_files{key_file,        certificate_file, permissions_file,    permissions_source,
                                   governance_file, identity_ca_file, permissions_ca_file, revocation_file};

/// Removes links among the own files of an enclave: what is written through one changes another enclave.
void remove_links(const fs::path& enclave) {
  for (const char* const file : {key_file, certificate_file, permissions_file, permissions_source}) {
    std::error_code error;
    if (fs::is_symlink(enclave / file, error)) fs::remove(enclave / file, error);
    if (error && error != std::errc::no_such_file_or_directory) {
      throw SecurityError(fmt::format("{}: {}", (enclave / file).string(), error.message()));
    }
  }
}

/// Links an enclave to the files of the whole store, after restoring the list of revoked certificates.
void link_shared_files(const fs::path& store, const fs::path& enclave, const std::string& issuer_pem) {
  link(certificate_path(store, identity_authority), enclave / identity_ca_file);
  link(certificate_path(store, permissions_authority), enclave / permissions_ca_file);
  link(store / "enclaves" / governance_file, enclave / governance_file);
  const std::string list = revocations(store, issuer_pem);
  if (list.empty()) return;
  write_revocations(store, list);
  link(store / "public" / revocation_file, enclave / revocation_file);
}

/// Returns the text of a signed document; empty if it has none that can be trusted.
std::string signed_text(const fs::path& store, const fs::path& document) {
  try {
    const std::string authority_pem = read_file(certificate_path(store, permissions_authority), "");
    return verified_document(read_file(document, ""), authority_pem, document.string());
  } catch (const SecurityError&) {
    return {};
  }
}

/// Returns the permissions of an enclave to be signed: permissions.xml, or what was signed if it is lost.
std::string own_permissions(const fs::path& store, const std::string& name) {
  const fs::path folder = store / "enclaves" / name;
  const fs::path source = folder / permissions_source;
  std::error_code absent;
  if (!fs::is_directory(folder, absent)) {
    throw SecurityError(
        fmt::format("{}: no such enclave; run {}", folder.string(), command_for(folder, "enclave")));
  }
  const std::string remedy =
      fmt::format("run {}, then {}", command_for(folder, "revoke"), command_for(folder, "enclave"));
  std::string text =
      fs::exists(source, absent) ? read_file(source, remedy) : signed_text(store, folder / permissions_file);
  if (text.empty()) throw SecurityError(fmt::format("{}: empty or lost; {}", source.string(), remedy));
  try {
    const std::string subject = grant_of(text, source.string()).subject;
    if (is_subject_of(name, subject)) return text;
    throw SecurityError(fmt::format("{}: of {}, not of this enclave", source.string(), subject));
  } catch (const SecurityError& error) {
    throw SecurityError(fmt::format("{}; edit it, or {}", error.what(), remedy));
  }
}

bool is_revoked(const fs::path& store, const fs::path& certificate, const std::string& issuer_pem) {
  try {
    const auto revoked = revoked_serials(revocations(store, issuer_pem), issuer_pem, revocation_file);
    const std::string serial = facts_of(read_file(certificate, ""), certificate_file).serial;
    return std::ranges::find(revoked, serial) != revoked.end();
  } catch (const SecurityError&) {
    return false;
  }
}

/// Removes the files of an enclave, and its folder unless another enclave or other files are in it.
void remove_enclave(const fs::path& folder) {
  for (const char* const file : enclave_files) {
    std::error_code error;
    fs::remove(folder / file, error);
    if (error) throw SecurityError(fmt::format("{}: {}", (folder / file).string(), error.message()));
  }
  std::error_code not_empty;
  fs::remove(folder, not_empty);
}

}  // namespace

void check_enclave_name(const std::string& name) {
  constexpr std::size_t max_name_bytes = 63;  // the subject of a certificate has 64, one is a slash
  constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./";
  // A name with "." or ".." would be another name of the same folder, or lead out of the store.
  const bool is_plain = std::ranges::none_of(fs::path(name), [](const fs::path& part) {
    return part.empty() || part == "/" || part == "." || part == "..";
  });
  if (name.size() > max_name_bytes) {
    throw SecurityError(fmt::format("'{}': longer than {} bytes", name, max_name_bytes));
  }
  if (!is_plain || name.empty() || name.find("//") != name.npos ||
      name.find_first_not_of(allowed) != name.npos) {
    throw SecurityError(fmt::format("'{}': not an enclave name, such as bridge or hall/robot", name));
  }
}

bool is_subject_of(const std::string& name, const std::string& subject) {
  const std::string common_name = "CN=/" + name;
  return subject == common_name || subject.ends_with("," + common_name);
}

KeyStore KeyStore::create(const fs::path& folder, Protection protection, std::int64_t now_s) {
  std::error_code absent;
  if (fs::exists(folder, absent) && !fs::is_empty(folder, absent)) {
    throw SecurityError(folder.string() + ": not empty; a key store needs a folder of its own");
  }
  constexpr auto all_read = fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                            fs::perms::others_read | fs::perms::others_exec;
  make_folder(folder, all_read);
  make_folder(folder / "private", fs::perms::owner_all);
  make_folder(folder / "public", all_read);
  make_folder(folder / "enclaves", all_read);
  const Validity validity{now_s - day_s, now_s + authority_days * day_s};
  const KeyPair identity = make_identity_authority(identity_authority_name, validity);
  write_pair(certificate_path(folder, identity_authority), key_path(folder, identity_authority), identity);
  write_pair(certificate_path(folder, permissions_authority), key_path(folder, permissions_authority),
             make_permissions_authority("sonopose permissions CA", validity));
  files::write_private(issued_path(folder), "");
  write_revocations(folder, revocation_list(identity, {}, now_s));
  KeyStore store(folder);
  store.set_protection(protection);
  return store;
}

KeyStore::KeyStore(const fs::path& folder) : folder_(fs::absolute(folder).lexically_normal()) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code error;
  if (!fs::is_directory(folder_ / "enclaves", error) || !fs::is_directory(folder_ / "public", error)) {
    throw SecurityError(fmt::format("{}: not a key store; make one with sonopose-security init {}",
                                    folder_.string(), folder_.string()));
  }
}

fs::path KeyStore::enclave_folder(const std::string& name) const {
  check_enclave_name(name);
  return folder_ / "enclaves" / name;
}

std::vector<std::string> KeyStore::enclaves() const {
  std::vector<std::string> names;
  const fs::path root = folder_ / "enclaves";
  for (const fs::path& file : files_below(root)) {
    const auto is_it = [&](const char* name) { return file.filename() == name; };
    if (file.parent_path() == root || std::ranges::none_of(enclave_files, is_it)) continue;
    names.push_back(file.parent_path().lexically_relative(root).string());
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::vector<fs::path> folders{folder};
  while (!folders.empty()) {
    const fs::path next = std::move(folders.back());
    folders.pop_back();
    std::error_code error;
    for (fs::directory_iterator each(next, error), end; !error && each != end; each.increment(error)) {
      std::error_code gone;
      const bool is_folder = !each->is_symlink(gone) && each->is_directory(gone);
      (is_folder ? folders : files).push_back(each->path());
    }
    if (!error) continue;
    throw SecurityError(fmt::format("{}: {}{}", next.string(), error.message(),
                                    error == std::errc::permission_denied ? "; run this as its owner" : ""));
  }
  std::ranges::sort(files);
  return files;
}

KeyPair KeyStore::authority(const char* name) const {
  const std::string remedy = "this needs the whole key store, with its private keys";
  return {read_file(certificate_path(folder_, name), remedy), read_file(key_path(folder_, name), remedy)};
}

void KeyStore::write_identity(const std::string& name, const KeyPair& identity) const {
  const fs::path folder = enclave_folder(name);
  const std::string serial = facts_of(identity.certificate_pem, certificate_file).serial;
  std::error_code absent;
  const fs::path issued = issued_path(folder_);
  const std::string earlier = fs::exists(issued, absent) ? read_file(issued, "") : "";
  files::write_private(issued, fmt::format("{}{} {}\n", earlier, serial, name));
  write_pair(folder / certificate_file, folder / key_file, identity);
}

void KeyStore::sign(const fs::path& document, const fs::path& file) const {
  files::write_whole(file, signed_document(read_file(document, "it is the source of " + file.string()),
                                           authority(permissions_authority)));
}

void KeyStore::add(const std::string& name, const EnclaveOptions& options) const {
  const files::Descriptor lock = locked(folder_);
  const fs::path folder = enclave_folder(name);
  std::error_code absent;
  const KeyPair issuer = authority(identity_authority);
  const fs::path certificate = folder / certificate_file;
  if (fs::exists(certificate, absent) && !is_revoked(folder_, certificate, issuer.certificate_pem)) {
    throw SecurityError(
        fmt::format("{}: this enclave exists already; sonopose-security renew {} {} gives "
                    "it a new certificate, revoke removes it",
                    folder.string(), folder_.string(), name));
  }
  const KeyPair identity = issue(issuer, "/" + name, options.validity, options.handshake);
  const Grant grant{.subject = facts_of(identity.certificate_pem, certificate_file).subject,
                    .validity = options.validity,
                    .access = access_of(options.roles),
                    .partitions = options.partitions};
  make_folder(folder, fs::perms::owner_all);
  remove_links(folder);
  link_shared_files(folder_, folder, issuer.certificate_pem);
  files::write_whole(folder / permissions_source, permissions_xml(grant));
  sign(folder / permissions_source, folder / permissions_file);
  write_identity(name, identity);  // last: its certificate makes the folder an enclave
}

void KeyStore::renew(const std::string& name, const Validity& validity) const {
  const files::Descriptor lock = locked(folder_);
  const fs::path folder = enclave_folder(name);
  const fs::path source = folder / permissions_source;
  const KeyPair issuer = authority(identity_authority);
  const std::string permissions = own_permissions(folder_, name);
  const bool is_qualified = grant_of(permissions, source.string()).subject.starts_with("dnQualifier=");
  remove_links(folder);
  link_shared_files(folder_, folder, issuer.certificate_pem);
  files::write_whole(source, with_validity(permissions, validity, source.string()));
  sign(source, folder / permissions_file);
  write_identity(name,
                 issue(issuer, "/" + name, validity, is_qualified ? Handshake::answers : Handshake::either));
}

std::size_t KeyStore::revoke(const std::string& name, std::int64_t now_s) const {
  const files::Descriptor lock = locked(folder_);
  const fs::path folder = enclave_folder(name);
  const KeyPair issuer = authority(identity_authority);
  std::error_code absent;
  std::vector<std::string> serials;
  if (const std::string list = revocations(folder_, issuer.certificate_pem); !list.empty()) {
    serials = revoked_serials(list, issuer.certificate_pem, revocation_file);
  }
  const std::size_t earlier = serials.size();
  const auto add_serial = [&serials](const std::string& serial) {
    if (std::ranges::find(serials, serial) == serials.end()) serials.push_back(serial);
  };
  const auto all = enclaves();
  const bool is_enclave = std::ranges::find(all, name) != all.end();
  try {
    const auto facts = facts_of(read_file(folder / certificate_file, ""), certificate_file);
    if (is_subject_of(name, facts.subject)) add_serial(facts.serial);
  } catch (const SecurityError&) {  // NOLINT(bugprone-empty-catch): one that cannot be read admits nobody
  }
  if (const fs::path issued = issued_path(folder_); fs::exists(issued, absent)) {
    std::istringstream lines(read_file(issued, ""));
    for (std::string serial, enclave; lines >> serial >> enclave;) {
      if (enclave == name) add_serial(serial);
    }
  }
  if (serials.size() == earlier && !is_enclave) {  // one may be left of a revocation that was interrupted
    throw SecurityError(fmt::format("{}: no such enclave, or it has been revoked", folder.string()));
  }
  write_revocations(folder_, revocation_list(issuer, serials, now_s));
  remove_enclave(folder);
  // The others of a store of SROS2 have no link to the list yet.
  for (const std::string& other : enclaves()) {
    link(folder_ / "public" / revocation_file, folder_ / "enclaves" / other / revocation_file);
  }
  return serials.size() - earlier;
}

std::string KeyStore::set_protection(std::optional<Protection> protection) const {
  const files::Descriptor lock = locked(folder_);
  const fs::path source = folder_ / "enclaves" / governance_source;
  const fs::path signed_one = folder_ / "enclaves" / governance_file;
  const std::string before = signed_text(folder_, signed_one);
  std::error_code absent;
  if (protection) {
    files::write_whole(source, governance_xml(*protection));
  } else if (!fs::exists(source, absent)) {
    if (before.empty()) throw SecurityError(source.string() + ": does not exist; use --protect");
    files::write_whole(source, before);
  }
  std::string after;
  try {
    after = protection_in(read_file(source, ""), source.string());
  } catch (const SecurityError& error) {
    throw SecurityError(std::string(error.what()) + "; use --protect");
  }
  sign(source, signed_one);
  return before.empty() ? after : protection_in(before, signed_one.string()) + " → " + after;
}

}  // namespace sonopose::security
