#include "schemas/common/revision.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <mutex>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

/// The field table of an earlier revision.
DocumentSchema table_of(const DocumentSchema& schema, std::int64_t revision) {
    return schema.restricted(
        fmt::format("{}.{}", version_of(schema).model, revision),
        [&](const FieldRule& rule) { return since_of(schema, rule.path) <= revision; });
}

/// The field table of an earlier revision, cached because making it takes far longer than reading a
/// document. Tables are identified by the text that they were parsed from.
const DocumentSchema& as_of(const DocumentSchema& schema, std::int64_t revision) {
    struct Made {
        YamlNode source;
        std::int64_t revision;
        DocumentSchema schema;
    };
    static std::mutex mutex;
    static std::deque<Made> all;  // references to its elements stay valid
    const std::lock_guard lock(mutex);
    for (const Made& made : all)
        if (made.revision == revision && made.source.is_same_as(schema.source().node()))
            return made.schema;
    all.push_back({schema.source().node(), revision, table_of(schema, revision)});
    return all.back().schema;
}

/// Refuses every key of a document that names a field of a later revision.
void refuse_later_fields(const YamlValue& value, const std::string& path,
                         const DocumentSchema& schema, std::int64_t revision) {
    if (value.is_list())
        for (const YamlValue& item : value.list())
            refuse_later_fields(item, path + "[]", schema, revision);
    if (!value.is_map()) return;
    for (const std::string& key : value.keys()) {
        // A key may be written "smooth.noise", which is not a field.
        if (key.find_first_of(".[") != std::string::npos) continue;
        const std::string field = path.empty() ? key : path + "." + key;
        const YamlValue member = value[key];
        if (const std::int64_t since = since_of(schema, field);
            schema.find(field) && since > revision) {
            const std::int64_t model = version_of(schema).model;
            member.fail(fmt::format("the field needs revision {0}.{1} of the schema {2}; the file "
                                    "follows {2}/{0}.{3}",
                                    model, since, schema.name(), revision),
                        fmt::format("Let the file say {}/{}.{}, or remove the field", schema.name(),
                                    model, since));
        }
        refuse_later_fields(member, field, schema, revision);
    }
}

}  // namespace

std::optional<SchemaVersion> parse_schema_version(std::string_view text) {
    const std::size_t point = text.find('.');
    if (point == std::string_view::npos || text.find_first_of("+-") != std::string_view::npos)
        return std::nullopt;
    const auto model = parse_integer(text.substr(0, point));
    const auto revision = parse_integer(text.substr(point + 1));
    if (!model || !revision) return std::nullopt;
    return SchemaVersion{*model, *revision};
}

SchemaVersion version_of(const DocumentSchema& schema) {
    return parse_schema_version(schema.version()).value();
}

namespace {

std::int64_t revision_of(const YamlValue& since, const SchemaVersion& own) {
    if (!since.exists()) return 0;
    const auto version = parse_schema_version(since.text());
    if (!version || version->model != own.model || version->revision > own.revision)
        since.fail("\"" + since.text() + "\" is no revision of this field table",
                   "Give one up to the table's own version");
    return version->revision;
}

}  // namespace

std::int64_t read_since(const YamlValue& entry, const SchemaVersion& own) {
    return revision_of(entry["since"], own);
}

std::int64_t since_of(const DocumentSchema& schema, const std::string& path) {
    const SchemaVersion own = version_of(schema);
    std::int64_t latest = 0;
    const auto add = [&](std::string_view field) {
        if (const FieldRule* rule = schema.find(field))
            latest = std::max(latest, revision_of(rule->since, own));
    };
    for (std::size_t end = path.find_first_of(".["); end != std::string::npos;
         end = path.find_first_of(".[", end + 1))
        add(std::string_view(path).substr(0, end));
    add(path);
    return latest;
}

void validate_revision(const YamlValue& document, const DocumentSchema& schema,
                       std::int64_t revision) {
    const std::int64_t own = version_of(schema).revision;
    if (revision >= own) return schema.validate(document, revision > own);
    refuse_later_fields(document, "", schema, revision);
    as_of(schema, revision).validate(document);
}

std::optional<std::int64_t> written_revision(const YamlValue& document,
                                             const DocumentSchema& schema) {
    const YamlValue written = document["schema"];
    if (!written.exists()) return std::nullopt;
    const std::string text = written.text();
    const SchemaVersion own = version_of(schema);
    for (std::int64_t revision = 0; revision <= own.revision; ++revision)
        if (text == fmt::format("{}/{}.{}", schema.name(), own.model, revision)) return revision;
    return std::nullopt;
}

std::string known_revisions(const DocumentSchema& schema) {
    const SchemaVersion own = version_of(schema);
    std::string text;
    for (std::int64_t revision = 0; revision <= own.revision; ++revision)
        text += fmt::format("{}{}/{}.{}", revision == 0 ? "" : " or ", schema.name(), own.model,
                            revision);
    return text;
}

}  // namespace runcert
