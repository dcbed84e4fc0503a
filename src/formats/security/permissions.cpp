#include "security/permissions.hpp"

#include "security/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <sstream>
#include <string_view>

namespace sonopose::security {
namespace {

constexpr const char* schema = "http://www.omg.org/spec/DDS-Security/20170801/omg_shared_ca_{}.xsd";

pugi::xml_node child(pugi::xml_node parent, const char* name, const std::string& text = {}) {
  pugi::xml_node added = parent.append_child(name);
  if (!text.empty()) added.append_child(pugi::node_pcdata).set_value(text.c_str());
  return added;
}

pugi::xml_node root_of(pugi::xml_document& document, const char* kind) {
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("dds");
  root.append_attribute("xmlns:xsi") = "http://www.w3.org/2001/XMLSchema-instance";
  root.append_attribute("xsi:noNamespaceSchemaLocation") = fmt::format(fmt::runtime(schema), kind).c_str();
  return root;
}

void add_all_domains(pugi::xml_node parent) {
  pugi::xml_node range = child(child(parent, "domains"), "id_range");
  child(range, "min", "0");
  child(range, "max", "230");  // the highest that Cyclone DDS accepts here
}

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

void add_rule(pugi::xml_node allow, const char* direction, const std::vector<std::string>& topics,
              const std::vector<std::string>& partitions) {
  if (topics.empty()) return;
  pugi::xml_node rule = child(allow, direction);
  pugi::xml_node list = child(rule, "topics");
  for (const std::string& topic : topics) child(list, "topic", topic);
  if (partitions.empty()) return;  // means the partition without a name
  pugi::xml_node names = child(rule, "partitions");
  for (const std::string& name : partitions) child(names, "partition", name);
}

pugi::xml_node grant_in(pugi::xml_document& document, const std::string& xml, const std::string& origin) {
  const pugi::xml_parse_result result = document.load_buffer(xml.data(), xml.size());
  if (!result) throw SecurityError(fmt::format("{}: not XML: {}", origin, result.description()));
  const pugi::xml_node grant = document.child("dds").child("permissions").child("grant");
  if (!grant) throw SecurityError(origin + ": no permissions with a grant");
  return grant;
}

std::int64_t time_in(const pugi::xml_node& node, const std::string& origin) {
  tm at{};
  const std::string text = node.text().get();
  const int fields = std::sscanf(text.c_str(), "%d-%d-%dT%d:%d:%d", &at.tm_year, &at.tm_mon, &at.tm_mday,
                                 &at.tm_hour, &at.tm_min, &at.tm_sec);
  const bool is_date = fields == 6 && at.tm_year >= 1900 && at.tm_year <= 9999 && at.tm_mon >= 1 &&
                       at.tm_mon <= 12 && at.tm_mday >= 1 && at.tm_mday <= 31 && at.tm_hour >= 0 &&
                       at.tm_hour <= 24 && at.tm_min >= 0 && at.tm_min <= 59 && at.tm_sec >= 0 &&
                       at.tm_sec <= 60;
  if (!is_date) throw SecurityError(fmt::format("{}: {}: no date: '{}'", origin, node.name(), text));
  at.tm_year -= 1900;
  at.tm_mon -= 1;
  return ::timegm(&at);
}

/// Adds the text of each element. Throws SecurityError for one that has other contents.
void add_texts(std::vector<std::string>& texts, const pugi::xml_node& list, const std::string& origin) {
  for (const pugi::xml_node each : list.children()) {
    const pugi::xml_node content = each.first_child();
    if (content.type() == pugi::node_element || content.next_sibling()) {
      throw SecurityError(fmt::format("{}: {}: '{}' has more than a text", origin, list.name(), each.name()));
    }
    if (std::ranges::find(texts, each.text().get()) == texts.end()) texts.emplace_back(each.text().get());
  }
}

/// Throws SecurityError for elements of a document that the reader does not understand.
void check_children(const pugi::xml_node& parent, std::initializer_list<std::string_view> known,
                    const std::string& origin) {
  for (const pugi::xml_node each : parent.children()) {
    if (each.type() != pugi::node_element || std::ranges::find(known, each.name()) != known.end()) continue;
    throw SecurityError(fmt::format("{}: {}: '{}' is not supported", origin, parent.name(), each.name()));
  }
}

}  // namespace

std::string permissions_xml(const Grant& grant) {
  pugi::xml_document document;
  pugi::xml_node node = child(child(root_of(document, "permissions"), "permissions"), "grant");
  const std::string name = grant.subject.substr(grant.subject.rfind('=') + 1);
  node.append_attribute("name") = name.c_str();
  child(node, "subject_name", grant.subject);
  pugi::xml_node validity = child(node, "validity");
  child(validity, "not_before", date_time_text(grant.validity.not_before_s));
  child(validity, "not_after", date_time_text(grant.validity.not_after_s));
  if (!grant.access.writes.empty() || !grant.access.reads.empty()) {
    pugi::xml_node allow = child(node, "allow_rule");
    add_all_domains(allow);
    add_rule(allow, "publish", grant.access.writes, grant.partitions);
    add_rule(allow, "subscribe", grant.access.reads, grant.partitions);
  }
  child(node, "default", "DENY");
  return text_of(document);
}

Grant grant_of(const std::string& xml, const std::string& origin) {
  pugi::xml_document document;
  const pugi::xml_node node = grant_in(document, xml, origin);
  Grant grant{.subject = node.child("subject_name").text().get(),
              .validity = {time_in(node.child("validity").child("not_before"), origin),
                           time_in(node.child("validity").child("not_after"), origin)},
              .access = {},
              .partitions = {}};
  if (node.next_sibling("grant")) {
    throw SecurityError(origin + ": several grants are not supported; use one enclave for each");
  }
  check_children(node, {"subject_name", "validity", "allow_rule", "default"}, origin);
  bool has_rule_without_partition = false;
  for (const pugi::xml_node allow : node.children("allow_rule")) {
    check_children(allow, {"domains", "publish", "subscribe"}, origin);
    for (const pugi::xml_node rule : allow.children()) {
      const bool writes = std::string_view(rule.name()) == "publish";
      if (!writes && std::string_view(rule.name()) != "subscribe") continue;
      check_children(rule, {"topics", "partitions"}, origin);
      add_texts(writes ? grant.access.writes : grant.access.reads, rule.child("topics"), origin);
      add_texts(grant.partitions, rule.child("partitions"), origin);
      has_rule_without_partition = has_rule_without_partition || !rule.child("partitions").child("partition");
    }
  }
  if (has_rule_without_partition && !grant.partitions.empty() &&
      std::ranges::find(grant.partitions, "") == grant.partitions.end()) {
    grant.partitions.emplace_back();
  }
  if (std::string_view(node.child("default").text().get()) == "ALLOW") {
    grant.access = {.writes = {"*"}, .reads = {"*"}};
  }
  return grant;
}

std::string with_validity(const std::string& xml, const Validity& validity, const std::string& origin) {
  pugi::xml_document document;
  const pugi::xml_node dates = grant_in(document, xml, origin).child("validity");
  dates.child("not_before").text().set(date_time_text(validity.not_before_s).c_str());
  dates.child("not_after").text().set(date_time_text(validity.not_after_s).c_str());
  return text_of(document);
}

std::string governance_xml(Protection protection) {
  const char* const kind = protection == Protection::encrypt ? "ENCRYPT" : "SIGN";
  pugi::xml_document document;
  pugi::xml_node rule = child(child(root_of(document, "governance"), "domain_access_rules"), "domain_rule");
  add_all_domains(rule);
  child(rule, "allow_unauthenticated_participants", "false");
  child(rule, "enable_join_access_control", "true");
  child(rule, "discovery_protection_kind", kind);
  child(rule, "liveliness_protection_kind", kind);
  // Messages as a whole are signed; so no stranger changes time stamps, which are outside of the data.
  child(rule, "rtps_protection_kind", "SIGN");
  pugi::xml_node topic = child(child(rule, "topic_access_rules"), "topic_rule");
  child(topic, "topic_expression", "*");
  child(topic, "enable_discovery_protection", "true");
  child(topic, "enable_liveliness_protection", "true");
  child(topic, "enable_read_access_control", "true");
  child(topic, "enable_write_access_control", "true");
  child(topic, "metadata_protection_kind", kind);
  child(topic, "data_protection_kind", "NONE");  // the data are part of the metadata's message
  return text_of(document);
}

std::string protection_in(const std::string& governance, const std::string& origin) {
  pugi::xml_document document;
  if (!document.load_buffer(governance.data(), governance.size())) throw SecurityError(origin + ": not XML");
  if (!document.select_node("//domain_rule")) throw SecurityError(origin + ": no domain_rule");
  std::string found;
  for (const pugi::xpath_node each : document.select_nodes("//topic_rule")) {
    const std::string kinds = std::string(each.node().child("metadata_protection_kind").text().get()) +
                              each.node().child("data_protection_kind").text().get();
    const char* const here = kinds.find("ENCRYPT") != kinds.npos ? "encrypt"
                             : kinds.find("SIGN") != kinds.npos  ? "sign"
                                                                 : "none";
    if (!found.empty() && found != here) return "mixed";
    found = here;
  }
  return found.empty() ? "none" : found;
}

std::string partitions_text(const Grant& grant) {
  std::vector<std::string> names = grant.partitions;
  std::ranges::replace(names, std::string(), R"("")");
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string words_of(const Grant& grant) {
  const auto list = [](const std::vector<std::string>& topics) {
    return topics.empty() ? "nothing" : fmt::format("{}", fmt::join(topics, ", "));
  };
  std::string text = fmt::format("writes {}; reads {}", list(grant.access.writes), list(grant.access.reads));
  if (!grant.partitions.empty()) text += "; in partitions " + partitions_text(grant);
  return text;
}

}  // namespace sonopose::security
