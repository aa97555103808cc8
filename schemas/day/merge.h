#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "store/yaml_input.h"

namespace runcert {

/// A part of a day file that is written in the words of an attempt, as JSON. What the field table
/// of attempt has as text stays the text that is written ("0042", "1.50"); a figure becomes a
/// number where it is one, and stays text otherwise. `path` is the part's in that table, empty for
/// the whole.
nlohmann::ordered_json attempt_keys(const YamlValue& part, const std::string& path = {});

/// An entry's keys over the day's defaults: maps are joined key by key, receivers by their id, any
/// other value is replaced. The entry's list says which receivers there are, in which order; where
/// it has none the defaults' list does. A null takes a default away.
nlohmann::ordered_json over_defaults(const nlohmann::ordered_json& defaults,
                                     const nlohmann::ordered_json& entry);

/// The same keys at every level in the order of the field table of attempt; unknown ones last.
nlohmann::ordered_json in_table_order(const nlohmann::ordered_json& keys,
                                      const std::string& path = {});

}  // namespace runcert
