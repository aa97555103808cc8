#include "schemas/observations/observations.h"

#include "schemas/common/enum_text.h"

namespace runcert {

YamlNode observations_field_table_node();

namespace {

static_assert(sizeof(Observation) <= 192, "recordings of millions of epochs are held whole");

constexpr EnumWords<FixKind, 9> fix_words{{{FixKind::unknown, "unknown"},
                                           {FixKind::none, "none"},
                                           {FixKind::single, "single"},
                                           {FixKind::dgps, "dgps"},
                                           {FixKind::sbas, "sbas"},
                                           {FixKind::ppp, "ppp"},
                                           {FixKind::float_ambiguities, "float"},
                                           {FixKind::fixed, "fixed"},
                                           {FixKind::dead_reckoning, "dead_reckoning"}}};

const TableFormat<Observation>& format() {
    static const TableFormat<Observation> instance = [] {
        using Row = Observation;
        std::vector<ColumnBinding<Row>> columns{column<Row, &Row::epoch>("epoch"),
                                                column<Row, &Row::time>("time"),
                                                column<Row, &Row::latitude_deg>("latitude"),
                                                column<Row, &Row::longitude_deg>("longitude"),
                                                column<Row, &Row::height_m>("height"),
                                                column<Row, &Row::plane_east_m>("plane_east"),
                                                column<Row, &Row::plane_north_m>("plane_north"),
                                                column<Row, &Row::plane_up_m>("plane_up")};
        bind_accuracy(columns);
        bind_recorded_velocity(columns);
        bind_quality(columns);
        return TableFormat<Row>(observations_field_table_node(), "schemas/observations/v1.yaml",
                                std::move(columns));
    }();
    return instance;
}

nlohmann::ordered_json records_json(const RecordCount& records) {
    nlohmann::ordered_json json;
    json["total"] = records.total;
    json["bad"] = records.bad;
    json["bad_records"] = nlohmann::ordered_json::array();
    for (const BadRecord& bad : records.bad_records) {
        nlohmann::ordered_json entry;
        if (bad.file) entry["file"] = *bad.file;
        if (bad.line) entry["line"] = *bad.line;
        if (bad.column) entry["column"] = *bad.column;
        entry["byte"] = bad.byte;
        entry["epoch"] = bad.epoch;
        entry["what"] = bad.what;
        json["bad_records"].push_back(std::move(entry));
    }
    return json;
}

RecordCount read_records(const YamlValue& meta) {
    RecordCount records;
    if (!meta.exists()) return records;
    records.total = meta["total"].integer();
    records.bad = meta["bad"].integer();
    for (const YamlValue& entry : meta["bad_records"].list()) {
        BadRecord bad;
        if (entry["file"].exists()) bad.file = static_cast<std::int32_t>(entry["file"].integer());
        if (entry["line"].exists()) bad.line = entry["line"].integer();
        if (entry["column"].exists()) bad.column = entry["column"].integer();
        bad.byte = entry["byte"].integer();
        bad.epoch = entry["epoch"].integer();
        bad.what = entry["what"].text();
        records.bad_records.push_back(std::move(bad));
    }
    return records;
}

}  // namespace

std::string_view to_text(FixKind fix) {
    return word_of(fix_words, fix);
}
bool from_text(std::string_view text, FixKind& fix) {
    return value_of(fix_words, text, fix);
}

template <int Axes>
Eigen::Matrix<double, Axes, Axes> stated_covariance(const StatedAccuracy& accuracy) {
    const Eigen::Vector3d sigma(accuracy.sigma_east_m.value_or(0.0),
                                accuracy.sigma_north_m.value_or(0.0),
                                accuracy.sigma_up_m.value_or(0.0));
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Identity();
    correlation(0, 1) = correlation(1, 0) = accuracy.correlation_east_north.value_or(0.0);
    correlation(0, 2) = correlation(2, 0) = accuracy.correlation_east_up.value_or(0.0);
    correlation(1, 2) = correlation(2, 1) = accuracy.correlation_north_up.value_or(0.0);
    const Eigen::Matrix3d covariance = sigma.asDiagonal() * correlation * sigma.asDiagonal();
    if constexpr (Axes == 1)
        return covariance.bottomRightCorner<1, 1>();
    else
        return covariance.topLeftCorner<Axes, Axes>();
}
template Eigen::Matrix<double, 1, 1> stated_covariance<1>(const StatedAccuracy&);
template Eigen::Matrix2d stated_covariance<2>(const StatedAccuracy&);
template Eigen::Matrix3d stated_covariance<3>(const StatedAccuracy&);

nlohmann::ordered_json recording_facts_json(const RecordingFacts& facts) {
    nlohmann::ordered_json json;
    json["receiver"] = facts.receiver;
    if (facts.first_epoch) {
        json["first_epoch_gps"] = to_iso(*facts.first_epoch, 9);
        json["first_epoch_utc"] = to_utc_iso(*facts.first_epoch, 9);
    }
    json["georeferenced"] = facts.georeferenced;
    json["vertical_measured"] = facts.vertical_measured;
    json["nominal_interval_s"] = facts.nominal_interval_s;
    set_optional(json, "position_resolution_m", facts.position_resolution_m);
    set_optional(json, "time_resolution_s", facts.time_resolution_s);
    json["time_source"] = facts.time_source;
    return json;
}

RecordingFacts read_recording_facts(const YamlValue& meta) {
    RecordingFacts facts;
    facts.receiver = meta["receiver"].text();
    facts.first_epoch = read_gps_time(meta["first_epoch_gps"]);
    facts.georeferenced = meta["georeferenced"].boolean();
    facts.vertical_measured = meta["vertical_measured"].boolean();
    facts.nominal_interval_s = meta["nominal_interval_s"].real();
    facts.position_resolution_m = meta["position_resolution_m"].optional_real();
    facts.time_resolution_s = meta["time_resolution_s"].optional_real();
    facts.time_source = meta["time_source"].text_or("unknown");
    return facts;
}

WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last) {
    WindowSpan span{.first_epoch = first_epoch,
                    .last_epoch = last_epoch,
                    .start = first,
                    .duration = {last.nanoseconds - first.nanoseconds},
                    .start_gps = std::nullopt};
    if (facts.first_epoch) span.start_gps = facts.first_epoch->plus_nanoseconds(first.nanoseconds);
    return span;
}

namespace {

nlohmann::ordered_json meta_of(const Observations& observations) {
    nlohmann::ordered_json meta = header_json(observations.header);
    meta.update(recording_facts_json(observations.facts));
    meta["format"] = observations.format;
    if (!observations.variant.empty()) meta["variant"] = observations.variant;
    if (!observations.device.empty()) meta["device"] = observations.device;
    meta["frame"] = observations.frame;
    meta["time_scale"] = observations.time_scale;
    if (!observations.time_origin.empty()) meta["time_origin"] = observations.time_origin;
    meta["accuracy_source"] = observations.accuracy_source;
    meta["solution_source"] = observations.solution_source;
    meta["records"] = records_json(observations.records);
    meta["notes"] = observations.notes;
    return meta;
}

Observations head_of(const YamlValue& meta) {
    Observations observations;
    observations.header = read_header(meta);
    observations.facts = read_recording_facts(meta);
    observations.format = meta["format"].text();
    observations.variant = meta["variant"].text_or("");
    observations.device = meta["device"].text_or("");
    observations.frame = meta["frame"].text();
    observations.time_scale = meta["time_scale"].text();
    observations.time_origin = meta["time_origin"].text_or("");
    observations.accuracy_source = meta["accuracy_source"].text();
    observations.solution_source = meta["solution_source"].text_or("unknown");
    observations.records = read_records(meta["records"]);
    for (const YamlValue& note : meta["notes"].list())
        observations.notes.push_back(note.text());
    return observations;
}

}  // namespace

std::string write_observations(const Observations& observations) {
    return format().write(meta_of(observations), observations.rows);
}

ObservationsWriter::ObservationsWriter(const Observations& head, EcsvWriter::Sink sink)
    : out_(format().begin(meta_of(head), std::move(sink))) {}

void ObservationsWriter::write(const Observation& row) {
    format().write_row(out_, row);
}

void ObservationsWriter::finish() {
    out_.finish();
}

Observations read_observations(std::string_view text, const std::string& where) {
    auto contents = format().read(text, where);
    Observations observations = head_of(contents.meta);
    observations.rows = std::move(contents.rows);
    return observations;
}

OpenTable<Observations> open_observations(std::string_view text, const std::string& where) {
    RowReader<Observation> rows(format(), text, where);
    return {head_of(rows.meta()), std::move(rows)};
}

}  // namespace runcert
