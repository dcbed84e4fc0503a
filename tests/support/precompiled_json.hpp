#pragma once
/// \file
/// nlohmann's JSON without its literal `""_json`, for the precompiled header of the tests: that inline
/// function makes g++ instantiate the whole parser in every file, which takes it a second.

// Declares the literal, and makes its definition a template that nobody instantiates.
#define _json(characters, size) /* NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */ \
  _json(characters, size);                                                                             \
  template <int>                                                                                       \
  nlohmann::json unused_literal(characters, size)

#include <nlohmann/json.hpp>

#undef _json

#include <string>

// support/precompiled.cpp has these: the parser takes two seconds in every file.
extern template nlohmann::json nlohmann::json::parse<std::string>(std::string&&,
                                                                  nlohmann::json::parser_callback_t, bool,
                                                                  bool);
extern template nlohmann::json nlohmann::json::parse<std::string&>(std::string&,
                                                                   nlohmann::json::parser_callback_t, bool,
                                                                   bool);
extern template nlohmann::json nlohmann::json::parse<const std::string&>(const std::string&,
                                                                         nlohmann::json::parser_callback_t,
                                                                         bool, bool);
