#include "schemas/enu/enu.h"

namespace runcert {

YamlNode enu_field_table_node();

namespace {

const TableFormat<EnuEpoch>& format() {
    static const TableFormat<EnuEpoch> instance(enu_field_table_node(), "schemas/enu/v1.yaml",
                                                enu_columns<EnuEpoch>());
    return instance;
}

}  // namespace

nlohmann::ordered_json frame_meta_json(const Header& header, const RecordingFacts& facts,
                                       const std::optional<FrameOrigin>& origin) {
    nlohmann::ordered_json meta = header_json(header);
    meta.update(recording_facts_json(facts));
    if (origin)
        meta["origin"] = {{"latitude_deg", origin->position.latitude.degrees()},
                          {"longitude_deg", origin->position.longitude.degrees()},
                          {"height_m", origin->position.height_m},
                          {"source", origin->source}};
    return meta;
}

std::optional<FrameOrigin> read_origin(const YamlValue& meta) {
    const YamlValue origin = meta["origin"];
    if (!origin.exists()) return std::nullopt;
    return FrameOrigin{
        .position = {.latitude = Angle::from_degrees(origin["latitude_deg"].real()),
                     .longitude = Angle::from_degrees(origin["longitude_deg"].real()),
                     .height_m = origin["height_m"].real()},
        .source = origin["source"].text()};
}

namespace {

EnuTable head_of(const YamlValue& meta) {
    return {.header = read_header(meta),
            .facts = read_recording_facts(meta),
            .origin = read_origin(meta),
            .rows = {}};
}

}  // namespace

std::string write_enu(const EnuTable& table) {
    return format().write(frame_meta_json(table.header, table.facts, table.origin), table.rows);
}

EnuWriter::EnuWriter(const EnuTable& head, EcsvWriter::Sink sink)
    : out_(format().begin(frame_meta_json(head.header, head.facts, head.origin), std::move(sink))) {
}

void EnuWriter::write(const EnuEpoch& row) {
    format().write_row(out_, row);
}

void EnuWriter::finish() {
    out_.finish();
}

EnuTable read_enu(std::string_view text, const std::string& where) {
    auto contents = format().read(text, where);
    EnuTable table = head_of(contents.meta);
    table.rows = std::move(contents.rows);
    return table;
}

OpenTable<EnuTable> open_enu(std::string_view text, const std::string& where) {
    RowReader<EnuEpoch> rows(format(), text, where);
    return {head_of(rows.meta()), std::move(rows)};
}

}  // namespace runcert
