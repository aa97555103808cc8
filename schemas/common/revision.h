#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "store/document_schema.h"

// A schema's version is MODEL.REVISION. A revision only adds. A field or column that was not in 1.0
// is marked `since: "1.1"` in the field table, and everything inside such a field belongs to that
// revision too. Files of an earlier revision are read with that revision's table.

namespace runcert {

struct SchemaVersion {
    std::int64_t model = 0;
    std::int64_t revision = 0;
};

/// Parses a version such as "1.0", two whole numbers without signs. Empty for any other text.
std::optional<SchemaVersion> parse_schema_version(std::string_view text);

/// The version of a field table itself.
SchemaVersion version_of(const DocumentSchema& schema);

/// The revision in which an entry of a field table was added: its `since`, or 0 without one.
/// Failure for text that is not a version, or is newer than `own`, which is a bug in the table.
std::int64_t read_since(const YamlValue& entry, const SchemaVersion& own);

/// The revision in which a field was added: its own, or that of a field that contains it.
std::int64_t since_of(const DocumentSchema& schema, const std::string& path);

/// Checks a document against the given revision of the schema's model. A document of an earlier
/// revision may use only that revision's fields. A later field is a Failure that names the revision
/// it needs. In a document of a later revision, unknown fields are ignored.
void validate_revision(const YamlValue& document, const DocumentSchema& schema,
                       std::int64_t revision);

/// The revision of a document written by a person, whose `schema` is "NAME/1.0" up to this
/// program's own revision. Empty where it is any other text, or missing.
std::optional<std::int64_t> written_revision(const YamlValue& document,
                                             const DocumentSchema& schema);

/// "attempt/1.0 or attempt/1.1 or attempt/1.2": what `written_revision` accepts, for messages.
std::string known_revisions(const DocumentSchema& schema);

}  // namespace runcert
