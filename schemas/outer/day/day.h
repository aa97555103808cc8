#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "store/document_schema.h"
#include "store/yaml_node.h"

namespace runcert {

/// One entry of a day's list: an attempt's file, or an attempt with the day's defaults filled in.
struct DayEntry {
    std::int64_t line = 0;  ///< of the day file, from 1
    std::string place{};    ///< "file:line:column", for messages
    /// An attempt's file as it is written; empty for an attempt that is written in the day file.
    std::string attempt{};
    std::string id{};  ///< empty where it has none
    /// What is written here, and the defaults: the keys of an attempt but its schema and id,
    /// receivers always as a list.
    YamlNode keys{};
    bool short_form = false;  ///< written with `recording` in place of `receivers`
    std::optional<Failure> refused = {};
};

/// A day, `schemas/day/v1.yaml`.
struct DayFile {
    std::string id;  ///< empty where not given
    std::vector<DayEntry> entries;
};

/// Reads a day's file. Failure with file, line, column and remedy where it is not YAML, not of this
/// schema, has an unusable id, unknown keys or defaults, or lists no attempt. What is wrong with
/// one entry is said in that entry. What an attempt demands beyond the day's own field table is not
/// looked at: `attempt_text` makes the text that `read_attempt` judges.
DayFile read_day_file(std::string_view text, const std::string& where);

/// The file of an attempt with that id and those keys. `comment` is its first line.
std::string attempt_text(const std::string& id, const YamlNode& keys, const std::string& comment);

const DocumentSchema& day_schema();

}  // namespace runcert
