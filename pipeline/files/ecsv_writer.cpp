#include <fmt/format.h>

#include <cmath>

#include "core/failure.h"
#include "core/text.h"
#include "files/ecsv.h"
#include "files/yaml_output.h"

namespace runcert {

std::string_view ecsv_name(CellType type) {
    switch (type) {
        case CellType::boolean:
            return "bool";
        case CellType::integer:
            return "int64";
        case CellType::real:
            return "float64";
        case CellType::text:
            return "string";
    }
    return {};
}

namespace {

nlohmann::ordered_json column_entry(const EcsvColumn& column) {
    nlohmann::ordered_json entry;
    entry["name"] = column.name;
    if (!column.unit.empty()) entry["unit"] = column.unit;
    entry["datatype"] = ecsv_name(column.type);
    if (column.type == CellType::real) entry["format"] = fmt::format("%.{}f", column.decimals);
    if (!column.description.empty()) entry["description"] = column.description;
    if (column.must_understand) entry["meta"] = {{"required", true}};
    return entry;
}

bool needs_quotes(std::string_view text) {
    return text.find_first_of(",\"#") != std::string_view::npos;
}

}  // namespace

EcsvWriter::EcsvWriter(std::vector<EcsvColumn> columns, const nlohmann::ordered_json& meta)
    : columns_(std::move(columns)) {
    nlohmann::ordered_json header;
    header["datatype"] = nlohmann::ordered_json::array();
    for (const EcsvColumn& column : columns_)
        header["datatype"].push_back(column_entry(column));
    header["delimiter"] = ",";
    if (!meta.is_null()) header["meta"] = meta;
    out_ = "# %ECSV 1.0\n# ---\n";
    const std::string yaml = to_yaml_text(header);
    std::size_t begin = 0;
    while (begin < yaml.size()) {
        const std::size_t end = yaml.find('\n', begin);
        out_.append("# ").append(yaml, begin, end - begin).append("\n");
        begin = end + 1;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        if (i > 0) out_ += ',';
        out_ += columns_[i].name;
    }
    out_ += '\n';
}

const EcsvColumn& EcsvWriter::begin_cell() {
    if (column_ == columns_.size()) {
        out_ += '\n';
        column_ = 0;
    }
    if (column_ > 0) out_ += ',';
    return columns_[column_++];
}

void EcsvWriter::boolean(bool value) {
    begin_cell();
    out_ += value ? "True" : "False";
}

void EcsvWriter::integer(std::int64_t value) {
    begin_cell();
    fmt::format_to(std::back_inserter(out_), "{}", value);
}

void EcsvWriter::real(double value) {
    const EcsvColumn& column = begin_cell();
    if (!std::isfinite(value))
        throw Failure("column " + column.name, "a result is not a finite number",
                      "This is a fault of the program or of its input; please report it with the "
                      "run folder");
    out_ += format_fixed(value, column.decimals);
}

void EcsvWriter::seconds(std::int64_t nanoseconds) {
    begin_cell();
    const bool negative = nanoseconds < 0;
    const auto magnitude = negative ? 0 - static_cast<std::uint64_t>(nanoseconds)
                                    : static_cast<std::uint64_t>(nanoseconds);
    constexpr std::uint64_t per_second = 1'000'000'000;
    fmt::format_to(std::back_inserter(out_), "{}{}.{:09}", negative ? "-" : "",
                   magnitude / per_second, magnitude % per_second);
}

void EcsvWriter::text(std::string_view value) {
    const EcsvColumn& column = begin_cell();
    if (value.empty() || !is_printable_ascii(value) || value.front() == ' ' || value.back() == ' ')
        throw Failure("column " + column.name,
                      "the text \"" + escape_for_message(value) + "\" cannot be a table cell",
                      "Use printable ASCII characters, without blanks at the ends");
    if (!needs_quotes(value)) {
        out_ += value;
        return;
    }
    out_ += '"';
    for (const char c : value) {
        if (c == '"') out_ += '"';
        out_ += c;
    }
    out_ += '"';
}

void EcsvWriter::missing() {
    begin_cell();
    // A row of nothing would be an empty line, which other readers pass over.
    if (columns_.size() == 1) out_ += "\"\"";
}

std::string EcsvWriter::take() && {
    if (column_ == columns_.size()) out_ += '\n';
    return std::move(out_);
}

}  // namespace runcert
