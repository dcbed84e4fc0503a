/// \file
/// The source of the precompiled header of all tests.

#include "support/precompiled_json.hpp"

template nlohmann::json nlohmann::json::parse<std::string>(std::string&&, nlohmann::json::parser_callback_t,
                                                           bool, bool);
template nlohmann::json nlohmann::json::parse<std::string&>(std::string&, nlohmann::json::parser_callback_t,
                                                            bool, bool);
template nlohmann::json nlohmann::json::parse<const std::string&>(const std::string&,
                                                                  nlohmann::json::parser_callback_t, bool,
                                                                  bool);
