#include "schemas/common/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "store/yaml_output.h"

namespace runcert {
namespace {

EcsvColumn read_column(const YamlValue& entry) {
    EcsvColumn column;
    column.name = entry["name"].text();
    static const std::map<std::string, CellType> types{{"integer", CellType::integer},
                                                       {"boolean", CellType::boolean},
                                                       {"text", CellType::text},
                                                       {"real", CellType::real}};
    const auto type = types.find(entry["type"].text());
    if (type == types.end())
        entry["type"].fail("\"" + entry["type"].text() + "\" is not a type",
                           "Use integer, real, boolean or text");
    column.type = type->second;
    if (column.type == CellType::real)
        column.decimals = static_cast<int>(entry["decimals"].integer());
    column.unit = entry["unit"].text_or("");
    column.description = entry["description"].text();
    return column;
}

[[noreturn]] void refuse(const EcsvReader& reader, const std::string& what) {
    throw Failure(reader.where(), what, take_the_original);
}

/// The index of the column in the table.
std::size_t match_column(const EcsvReader& reader, const EcsvColumn& expected) {
    const auto found = std::ranges::find(reader.columns(), expected.name, &EcsvColumn::name);
    if (found == reader.columns().end())
        refuse(reader, fmt::format("the column \"{}\" is missing", expected.name));
    if (found->type != expected.type || found->unit != expected.unit)
        refuse(reader, fmt::format("the column \"{}\" is {} in \"{}\", expected {} in \"{}\"",
                                   expected.name, ecsv_name(found->type), found->unit,
                                   ecsv_name(expected.type), expected.unit));
    return static_cast<std::size_t>(found - reader.columns().begin());
}

}  // namespace

TableSchema TableSchema::read(const YamlNode& table, const std::string& where) {
    TableSchema schema;
    schema.meta_ = DocumentSchema::read(table, where, &header_schema());
    for (const YamlValue& entry : schema.meta_.source()["columns"].list())
        schema.columns_.push_back(read_column(entry));
    return schema;
}

std::vector<std::size_t> TableSchema::match(const EcsvReader& reader) const {
    const YamlValue meta(reader.meta(), reader.where());
    check_version(meta, meta_);
    meta_.validate(meta);
    std::vector<std::size_t> index;
    for (const EcsvColumn& expected : columns_)
        index.push_back(match_column(reader, expected));
    for (const EcsvColumn& column : reader.columns())
        if (std::ranges::find(columns_, column.name, &EcsvColumn::name) == columns_.end())
            refuse(reader, fmt::format("the column \"{}\" is not known", column.name));
    return index;
}

EcsvWriter TableSchema::begin(OpaqueJson meta, EcsvWriter::Sink sink) const {
    nlohmann::ordered_json header = *meta;
    header["schema"] = {{"name", meta_.name()}, {"version", meta_.version()}};
    round_to_table(header, meta_);
    meta_.validate(YamlValue(yaml_node_of(header), "header of the table"));
    return EcsvWriter(columns_, header, std::move(sink));
}

}  // namespace runcert
