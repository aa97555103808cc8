#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "reports/audit/sections.h"

namespace runcert {
namespace {

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

std::string report_text(const RunRecord& record) {
    if (!record.report) return "report.json is not in the folder";
    return fmt::format("id {}", record.report_id);
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
        facts.facts.push_back({"Receiver " + one.receiver.id, one.recording});
    facts.facts.push_back({"Rules claimed under", listed(attempt.profiles)});
    if (attempt.record) facts.facts.push_back({"Record to beat", record_text(*attempt.record)});
    for (const auto& [profile, beaten] : attempt.records)
        facts.facts.push_back({"Record under " + profile, record_text(beaten)});
    facts.facts.push_back({"Report", report_text(record)});
    facts.facts.push_back({"Signatures", signatures_text(record)});
    return facts;
}

std::vector<Block> makers_of(const std::vector<Product>& products) {
    FactTable table{.caption = "Who made the files",
                    .heads = {"stage", "receiver", "file", "program", "source revision"},
                    .rows = {}};
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

}  // namespace

Section run_section(const RunRecord& record, const WalkOptions& options) {
    const std::vector<Product> products = products_of(record);
    Section section{.title = "The run", .blocks = {facts_of(record)}};
    const auto add = [&](std::vector<Block> blocks) {
        for (Block& block : blocks)
            section.blocks.push_back(std::move(block));
    };
    add(makers_of(products));
    add(missing_of(products));
    add(replaced_of(record.attempt));
    add({Paragraph{
        "Every hash (SHA-256) that one file of the folder names of another that is there was "
        "computed again, and holds."}});
    if (!options.all) add({Paragraph{"Hashes are cut to their first digits (--all: in full)."}});
    return section;
}

}  // namespace runcert
