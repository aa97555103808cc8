#include "schemas/common/table.h"

#include <fmt/format.h>

#include <algorithm>

namespace runcert {
namespace {

EcsvColumn read_column(const YamlValue& entry) {
    EcsvColumn column;
    column.name = entry["name"].text();
    const std::string type = entry["type"].text();
    if (type == "integer")
        column.type = CellType::integer;
    else if (type == "boolean")
        column.type = CellType::boolean;
    else if (type == "text")
        column.type = CellType::text;
    else if (type == "real")
        column.decimals = static_cast<int>(entry["decimals"].integer());
    else
        entry["type"].fail("\"" + type + "\" is not a type", "Use integer, real, boolean or text");
    column.unit = entry["unit"].text_or("");
    column.description = entry["description"].text();
    column.must_understand = entry["required"].exists() && entry["required"].boolean();
    return column;
}

[[noreturn]] void refuse(const EcsvReader& reader, const std::string& what) {
    throw Failure(reader.where(), what,
                  "The file is not as the program writes it; take the original, or run the stage "
                  "again");
}

}  // namespace

TableSchema TableSchema::parse(std::string_view text, const std::string& where) {
    TableSchema schema;
    schema.meta_ = DocumentSchema::parse(text, where, &header_schema());
    for (const YamlValue& entry : schema.meta_.source()["columns"].list())
        schema.columns_.push_back(read_column(entry));
    return schema;
}

std::vector<std::size_t> TableSchema::match(const EcsvReader& reader) const {
    const YamlValue meta(reader.meta(), reader.where());
    const bool newer = check_version(meta, meta_);
    meta_.validate(meta, newer);
    std::vector<std::size_t> index;
    for (const EcsvColumn& expected : columns_) {
        const auto found =
            std::find_if(reader.columns().begin(), reader.columns().end(),
                         [&](const EcsvColumn& column) { return column.name == expected.name; });
        if (found == reader.columns().end())
            refuse(reader, fmt::format("the column \"{}\" is missing", expected.name));
        if (found->type != expected.type || found->unit != expected.unit)
            refuse(reader, fmt::format("the column \"{}\" is {} in \"{}\", expected {} in \"{}\"",
                                       expected.name, ecsv_name(found->type), found->unit,
                                       ecsv_name(expected.type), expected.unit));
        index.push_back(static_cast<std::size_t>(found - reader.columns().begin()));
    }
    for (const EcsvColumn& column : reader.columns()) {
        const bool known =
            std::any_of(columns_.begin(), columns_.end(),
                        [&](const EcsvColumn& own) { return own.name == column.name; });
        if (!known && (!newer || column.must_understand))
            refuse(reader, fmt::format("the column \"{}\" is not known", column.name));
    }
    return index;
}

}  // namespace runcert
