#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"
#include "store/ecsv.h"
#include "store/yaml_output.h"

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
    return entry;
}

/// Whether a text can stand in a cell, and as it is.
bool is_plain(std::string_view text) {
    bool plain = !text.empty();
    for (const char c : text)
        plain = plain && c > ' ' && c <= '~' && c != ',' && c != '"' && c != '#';
    return plain;
}

constexpr std::size_t buffer_bytes = std::size_t{256} * 1024;

}  // namespace

EcsvWriter::EcsvWriter(std::vector<EcsvColumn> columns, const nlohmann::ordered_json& meta,
                       Sink sink)
    : columns_(std::move(columns)), sink_(std::move(sink)), buffer_(buffer_bytes) {
    nlohmann::ordered_json header;
    header["datatype"] = nlohmann::ordered_json::array();
    for (const EcsvColumn& column : columns_)
        header["datatype"].push_back(column_entry(column));
    header["delimiter"] = ",";
    if (!meta.is_null()) header["meta"] = meta;
    put("# %ECSV 1.0\n# ---\n");
    const std::string yaml = to_yaml_text(header, YamlLetters::ascii);
    std::size_t begin = 0;
    while (begin < yaml.size()) {
        const std::size_t end = yaml.find('\n', begin);
        put("# " + yaml.substr(begin, end - begin) + "\n");
        begin = end + 1;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i)
        put((i > 0 ? "," : "") + columns_[i].name);
    put("\n");
}

void EcsvWriter::flush() {
    const std::string_view piece(buffer_.data(), used_);
    if (sink_)
        sink_(piece);
    else
        whole_ += piece;
    used_ = 0;
}

void EcsvWriter::put(std::string_view text) {
    while (!text.empty()) {
        if (used_ == buffer_.size()) flush();
        const std::size_t count = std::min(text.size(), buffer_.size() - used_);
        std::memcpy(buffer_.data() + used_, text.data(), count);
        used_ += count;
        text.remove_prefix(count);
    }
}

/// Writes what stands before a cell, and makes room for a number.
const EcsvColumn& EcsvWriter::begin_cell() {
    if (buffer_.size() - used_ < 1 + fixed_text_room) flush();
    if (column_ == columns_.size()) {
        buffer_[used_++] = '\n';
        column_ = 0;
    } else if (column_ > 0) {
        buffer_[used_++] = ',';
    }
    return columns_[column_++];
}

void EcsvWriter::boolean(bool value) {
    begin_cell();
    put(value ? "True" : "False");
}

/// A whole number of the last of so many decimals.
void EcsvWriter::scaled(std::int64_t value, int decimals) {
    begin_cell();
    const bool negative = value < 0;
    const auto magnitude =
        negative ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
    if (magnitude >= fixed_text_limit) {
        std::string digits = std::to_string(magnitude);
        if (decimals > 0) digits.insert(digits.size() - static_cast<std::size_t>(decimals), ".");
        return put((negative ? "-" : "") + digits);
    }
    char* const at = buffer_.data() + used_;
    used_ += static_cast<std::size_t>(write_scaled(at, magnitude, decimals, negative) - at);
}

void EcsvWriter::integer(std::int64_t value) {
    scaled(value, 0);
}

void EcsvWriter::seconds(std::int64_t nanoseconds) {
    scaled(nanoseconds, 9);
}

void EcsvWriter::real(double value) {
    const EcsvColumn& column = begin_cell();
    char* const at = buffer_.data() + used_;
    if (const char* const end = write_fixed_quickly(at, value, column.decimals)) {
        used_ += static_cast<std::size_t>(end - at);
        return;
    }
    if (!std::isfinite(value))
        throw Failure("column " + column.name, "a result is not a finite number",
                      "This is a fault of the program or of its input; please report it with the "
                      "run folder");
    put(format_fixed(value, column.decimals));
}

void EcsvWriter::text(std::string_view value) {
    const EcsvColumn& column = begin_cell();
    if (is_plain(value)) return put(value);
    if (value.empty() || !is_printable_ascii(value) || value.front() == ' ' || value.back() == ' ')
        throw Failure("column " + column.name,
                      "the text \"" + escape_for_message(value) + "\" cannot be a table cell",
                      "Use printable ASCII characters, without blanks at the ends");
    if (value.find_first_of(",\"#") == std::string_view::npos) return put(value);
    std::string quoted(value);
    replace_all(quoted, "\"", "\"\"");
    put('"' + quoted + '"');
}

void EcsvWriter::missing() {
    begin_cell();
    // A row of nothing would be an empty line, which other readers pass over.
    if (columns_.size() == 1) put("\"\"");
}

void EcsvWriter::finish() {
    if (column_ == columns_.size()) put("\n");
    column_ = 0;
    flush();
}

std::string EcsvWriter::take() && {
    finish();
    return std::move(whole_);
}

}  // namespace runcert
