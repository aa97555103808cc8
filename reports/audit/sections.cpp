#include "reports/audit/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/prose.h"
#include "core/text.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// The first digits of a hash, or all.
std::string hash_text(const std::string& sha256, bool all) {
    constexpr std::size_t enough_to_tell_apart = 12;
    return all || sha256.size() <= enough_to_tell_apart ? sha256
                                                        : sha256.substr(0, enough_to_tell_apart);
}

FactTable inputs_table(const RunRecord& record, const Header& header, bool all) {
    FactTable table{.caption = "Came in",
                    .heads = {"as", "file", "bytes", "SHA-256", "in the folder"}};
    for (const InputFile& input : header.inputs) {
        const std::string handed_in =
            input.original.empty() ? "" : " (handed in as " + input.original + ")";
        table.rows.push_back(
            {input.role, input.file + handed_in, counted(static_cast<std::int64_t>(input.bytes)),
             hash_text(input.sha256, all), record.files.contains(input.file) ? "yes" : "NO"});
    }
    return table;
}

std::string named_text(const RunRecord& record, const std::string& file) {
    const auto named = record.named_by.find(file);
    if (named == record.named_by.end() || named->second.empty())
        return "by no file of the folder: nothing shows that it was not changed";
    return "by " + listed(named->second);
}

/// The field table's rule of a stage's parameter; null where it has none.
const FieldRule* rule_of(const std::string& stage, const std::string& name) {
    if (stage == "import") return attempt_schema().find("receivers[]." + name);
    return attempt_schema().find(fmt::format("parameters.{}.{}", stage, name));
}

Json default_of(const FieldRule& rule, const std::string& craft_class) {
    return json_from_yaml(rule.default_value.is_map() ? rule.default_value[craft_class]
                                                      : rule.default_value);
}

std::string value_text(const Json& value) {
    if (value.is_number_float()) return quantity_text(value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::vector<std::string> items;
    for (const Json& item : value)
        items.push_back(value_text(item));
    return listed(items);
}

bool is_same(const Json& a, const Json& b) {
    return a.is_number() && b.is_number() ? a.get<double>() == b.get<double>() : a == b;
}

std::string set_by(const Attempt& attempt, const std::string& path, bool is_default) {
    const bool stated = path.starts_with("import.") ||  // which has what the attempt states, alone
                        std::ranges::find(attempt.overrides, path) != attempt.overrides.end();
    if (stated) return is_default ? "the attempt, to the default" : "the attempt";
    return is_default ? "default" : "NOT THE ATTEMPT: another program's default, or changed";
}

struct Product {
    std::string stage;
    std::string receiver;
    std::string file;
    const Header* header = nullptr;  ///< null where the file is not there
};

template <class T>
const Header* header_of(const std::optional<T>& product) {
    return product ? &product->header : nullptr;
}

std::vector<Product> products_of(const RunRecord& record) {
    std::vector<Product> products;
    for (const ReceiverRecord& one : record.receivers) {
        const std::string& id = one.receiver.id;
        products.push_back({"import", id, one.observations_file, header_of(one.observations)});
        products.push_back({"enu", id, one.enu_file, header_of(one.enu)});
        products.push_back({"screen", id, one.screened_file, header_of(one.screened)});
        products.push_back({"smooth", id, one.trajectory_file, header_of(one.trajectory)});
        products.push_back({"window", id, one.windows_file, header_of(one.windows)});
    }
    products.push_back({"check", {}, record.verdict_file, header_of(record.verdict)});
    products.push_back({"report", {}, "report.json", record.report ? &*record.report : nullptr});
    return products;
}

std::string record_text(const Record& record) {
    return fmt::format("{} {}, by: {}", quantity_text(record.speed), record.unit, record.source);
}

std::string officials_text(const std::vector<Official>& officials) {
    std::vector<std::string> people;
    for (const Official& official : officials)
        people.push_back(official.name.empty() ? official.role
                                               : official.role + " " + official.name);
    return people.empty() ? "none named" : listed(people);
}

std::string signatures_text(const RunRecord& record) {
    if (!record.report) return "none";
    if (record.signatures.empty()) return "none: the report is UNSIGNED";
    return listed(record.signatures) + ": whether they hold, `runcert verify` says";
}

Facts facts_of(const RunRecord& record) {
    const Attempt& attempt = record.attempt;
    Facts facts{{{"Attempt", attempt.id},
                 {"Craft", fmt::format("{}, class {}", attempt.craft.name, attempt.craft.kind)},
                 {"Place", attempt.place.empty() ? "not given" : attempt.place},
                 {"Date", attempt.date.empty() ? "not given" : attempt.date},
                 {"Officials", officials_text(attempt.officials)}}};
    for (const ReceiverRecord& one : record.receivers)
        facts.add("Receiver " + one.receiver.id, one.recording);
    facts.add("Rules claimed under", listed(attempt.profiles));
    if (attempt.record) facts.add("Record to beat", record_text(*attempt.record));
    for (const auto& [profile, beaten] : attempt.records)
        facts.add("Record under " + profile, record_text(beaten));
    facts.add("Report",
              record.report ? "id " + record.report_id : "report.json is not in the folder");
    facts.add("Signatures", signatures_text(record));
    return facts;
}

std::vector<Block> makers_of(const std::vector<Product>& products) {
    FactTable table{.caption = "Who made the files",
                    .heads = {"stage", "receiver", "file", "program", "source revision"}};
    std::set<std::string> makers;
    for (const Product& product : products) {
        const Header* header = product.header;
        if (header) makers.insert(header->program_version + " " + header->source_revision);
        table.rows.push_back({product.stage, product.receiver, product.file,
                              header ? "runcert " + header->program_version : "MISSING",
                              header ? header->source_revision : ""});
    }
    const std::string finding =
        makers.empty() ? "No file of a stage is there."
        : makers.size() == 1
            ? "All of them were made by the same program."
            : fmt::format("They were made by {} DIFFERENT versions of the program.", makers.size());
    return {std::move(table), Paragraph{finding}};
}

std::vector<Block> missing_of(const std::vector<Product>& products) {
    std::vector<std::string> missing;
    for (const Product& product : products)
        if (!product.header) missing.push_back(fmt::format("{} ({})", product.file, product.stage));
    if (missing.empty()) return {};
    return {Paragraph{fmt::format(
        "MISSING from the folder: {}. The walk has nothing to show there, and the hashes that "
        "these files name are not checked.",
        listed(missing))}};
}

std::vector<Block> replaced_of(const Attempt& attempt) {
    if (attempt.overrides.empty() && attempt.rules.empty())
        return {Paragraph{"The attempt replaces no parameter and no figure of a rule."}};
    std::vector<std::string> figures = attempt.overrides;
    for (const ReplacedFigure& figure : attempt.rules)
        figures.push_back(figure.profile + " " + figure.figure);
    return {Paragraph{
        fmt::format("The attempt replaces {}; the stages below say what by.", listed(figures))}};
}

/// What the run is, who made its files, and what is missing.
Section run_section(const RunRecord& record, bool all) {
    const std::vector<Product> products = products_of(record);
    Section section{.title = "The run", .blocks = {facts_of(record)}};
    section.add(makers_of(products));
    section.add(missing_of(products));
    section.add(replaced_of(record.attempt));
    section.add(Paragraph{
        "Every hash (SHA-256) that one file of the folder names of another that is there was "
        "computed again, and holds."});
    if (!all) section.add(Paragraph{"Hashes are cut to their first digits (--all: in full)."});
    return section;
}

}  // namespace

Section product_section(const RunRecord& record, const std::string& title, const Header& header,
                        const std::string& file, const std::string& contents, bool all) {
    const InputFile& own = record.files.at(file);
    return {
        .title = title,
        .blocks = {inputs_table(record, header, all),
                   Facts{{{"Went out", fmt::format("{}: {}, {} bytes", file, contents,
                                                   counted(static_cast<std::int64_t>(own.bytes)))},
                          {"Its SHA-256", hash_text(own.sha256, all)},
                          {"That hash is named", named_text(record, file)},
                          {"Made by", fmt::format("runcert {}, source {}; schema {} {}",
                                                  header.program_version, header.source_revision,
                                                  header.schema_name, header.schema_version)}}}}};
}

Section missing_section(const std::string& title, const std::string& file) {
    return {.title = title,
            .blocks = {Paragraph{fmt::format(
                "{} is MISSING from the folder: what this stage decided cannot be shown. The walk "
                "goes on with what is there.",
                file)}}};
}

std::string stage_title(const std::string& stage, const std::string& receiver) {
    const auto& stages = audited_stages();
    const auto number = std::find(stages.begin(), stages.end(), stage) - stages.begin() + 1;
    return fmt::format("{}. {}{}", number, stage, receiver.empty() ? "" : ", receiver " + receiver);
}

std::string file_speed_text(double speed_m_s) {
    return format_fixed(speed_m_s, 6) + " m/s";
}

std::string span_text(const WindowSpan& span) {
    return fmt::format("{} s from {} s on (epochs {} to {}{})",
                       format_fixed(span.duration.seconds(), 3),
                       format_fixed(span.start.seconds(), 3), span.first_epoch, span.last_epoch,
                       span.start_gps ? "; " + to_utc_iso(*span.start_gps, 3) : "");
}

std::vector<Block> parameter_blocks(const Attempt& attempt, const Header& header, bool all) {
    if (header.parameters->empty()) return {Paragraph{"Parameters. The stage has none."}};
    FactTable table{.heads = {"parameter", "used", "default", "unit", "set by"}};
    std::int64_t replaced = 0;
    for (const auto& [name, used] : header.parameters->items()) {
        const std::string path = header.stage + "." + name;
        const FieldRule* rule = rule_of(header.stage, name);
        const Json fallback = rule ? default_of(*rule, attempt.craft.kind) : Json();
        const bool is_default = rule && is_same(used, fallback);
        replaced += is_default ? 0 : 1;
        if (!is_default || all)
            table.rows.push_back({path, value_text(used),
                                  !rule                ? "not known"
                                  : fallback.is_null() ? "none"
                                                       : value_text(fallback),
                                  rule ? rule->unit : "", set_by(attempt, path, is_default)});
    }
    const auto count = static_cast<std::int64_t>(header.parameters->size());
    std::vector<Block> blocks;
    if (replaced == 0)
        blocks.emplace_back(Paragraph{
            fmt::format("Parameters. All {} have the default of the class {}{}.", counted(count),
                        attempt.craft.kind, all ? "" : " (--all lists them)")});
    else
        table.caption = fmt::format("Parameters, {} of {} not the default of the class {}",
                                    counted(replaced), counted(count), attempt.craft.kind);
    if (!table.rows.empty()) blocks.emplace_back(std::move(table));
    return blocks;
}

const std::vector<std::string>& audited_stages() {
    static const std::vector<std::string> stages{"import", "enu",    "screen",
                                                 "smooth", "window", "check"};
    return stages;
}

Walk walk_through(const RunRecord& record, const WalkOptions& options) {
    Walk walk{.title = fmt::format("Audit of the attempt {}", record.attempt.id)};
    if (options.stages.empty()) walk.sections.push_back(run_section(record, options.all));
    const auto is_asked = [&](const std::string& stage) {
        return options.stages.empty() || options.stages.contains(stage);
    };
    using Make = Section (*)(const RunRecord&, const ReceiverRecord&, bool);
    constexpr std::pair<const char*, Make> makers[] = {{"import", import_section},
                                                       {"enu", enu_section},
                                                       {"screen", screen_section},
                                                       {"smooth", smooth_section},
                                                       {"window", window_section}};
    for (const auto& [stage, make] : makers)
        for (const ReceiverRecord& one : record.receivers)
            if (is_asked(stage) &&
                (options.receiver.empty() || options.receiver == one.receiver.id))
                walk.sections.push_back(make(record, one, options.all));
    if (is_asked("check")) walk.sections.push_back(check_section(record, options.all));
    return walk;
}

}  // namespace runcert
