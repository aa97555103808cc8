#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "files/document_schema.h"

// A schema's version is MODEL.REVISION. A revision only adds: a field or column of the field table
// that was not in 1.0 says so by `since: "1.1"`, and what stands inside such a field is of that
// revision too. Files of an earlier revision are read by the table as that revision had it.

namespace runcert {

struct SchemaVersion {
    std::int64_t model = 0;
    std::int64_t revision = 0;
};

/// "1.0", as two whole numbers without signs; nothing for any other text.
std::optional<SchemaVersion> parse_schema_version(std::string_view text);

/// The version of a field table itself.
SchemaVersion version_of(const DocumentSchema& schema);

/// The revision that an entry of a field table was added in: its `since`, 0 where it has none. A
/// text that is no version, or one newer than `own`, is a fault of the table: Failure.
std::int64_t read_since(const YamlValue& entry, const SchemaVersion& own);

/// The revision that a field was added in: its own, or that of a field it stands inside.
std::int64_t since_of(const DocumentSchema& schema, const std::string& path);

/// Checks a document of that revision of the schema's model. Of an earlier revision: against the
/// fields it had; a later field is a Failure that says which revision it needs. Of a later one:
/// fields that are not known are passed over.
void validate_revision(const YamlValue& document, const DocumentSchema& schema,
                       std::int64_t revision);

/// The revision of a document written by a person, whose `schema` is "NAME/1.0" up to this
/// program's own revision; nothing where it is another text, or missing.
std::optional<std::int64_t> written_revision(const YamlValue& document,
                                             const DocumentSchema& schema);

/// "attempt/1.0 or attempt/1.1 or attempt/1.2": what `written_revision` knows, for messages.
std::string known_revisions(const DocumentSchema& schema);

}  // namespace runcert
