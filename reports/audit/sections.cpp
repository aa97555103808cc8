#include "reports/audit/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/claimed_text.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/words/attempt.h"
#include "schemas/common/product_files.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// The first digits of a hash, or all.
std::string hash_text(const std::string& sha256, Level level) {
    constexpr std::size_t enough_to_tell_apart = 12;
    return level == Level::all || sha256.size() <= enough_to_tell_apart
               ? sha256
               : sha256.substr(0, enough_to_tell_apart);
}

Block inputs_table(const RunRecord& record, const Header& header, Level level) {
    Block inputs = table({"as", "file", ">bytes", "SHA-256", "in the folder"}, "Came in");
    for (const InputFile& input : header.inputs) {
        TableRow& row = add_row(
            inputs, {input.role, input.file, counted(static_cast<std::int64_t>(input.bytes)),
                     hash_text(input.sha256, level),
                     file_in(record, input.file) != nullptr ? "yes" : "NO"});
        if (!input.original.empty()) row.further = {"handed in as " + input.original};
    }
    return inputs;
}

std::string named_text(const RunRecord& record, const std::string& file) {
    const auto named = record.named_by.find(file);
    if (named == record.named_by.end() || named->second.empty())
        return "by no file of the folder: nothing shows that it was not changed";
    return "by " + listed(named->second);
}

struct Product {
    std::string stage;
    std::string receiver;
    std::string file;
    const Header* header = nullptr;  ///< null where the file is not there
    /// Of a receiver's: whose, and what makes its blocks.
    const ReceiverResults* of = nullptr;
    std::vector<Block> (*blocks)(const RunRecord&, const ReceiverResults&, Level) = nullptr;
};

const Header* header_if_there(const Header& header) {
    return is_there(header) ? &header : nullptr;
}

std::vector<Product> products_of(const RunRecord& record) {
    std::vector<Product> products;
    for (const ReceiverResults& one : record.receivers) {
        const std::string& id = one.receiver.id;
        products.push_back({"import", id, one.files.at("observations"),
                            header_if_there(one.observations.header), &one, import_blocks});
        products.push_back(
            {"enu", id, one.files.at("enu"), header_if_there(one.enu.header), &one, enu_blocks});
        products.push_back({"screen", id, one.files.at("screened"),
                            header_if_there(one.screened.header), &one, screen_blocks});
        products.push_back({"smooth", id, one.files.at("trajectory"),
                            header_if_there(one.trajectory.header), &one, smooth_blocks});
        products.push_back({"window", id, one.files.at("windows"),
                            header_if_there(one.windows.header), &one, window_stage_blocks});
    }
    products.push_back(
        {"check", {}, std::string(products::verdict_file), header_if_there(record.verdict.header)});
    products.push_back({"report", {}, "report.json", record.report ? &*record.report : nullptr});
    return products;
}

std::string record_text(const Record& record) {
    return fmt::format("{}, by: {}", number_text(record.speed, record.unit),
                       claimed(record.source));
}

std::string signatures_text(const RunRecord& record) {
    if (!record.report) return "none";
    if (record.signatures.empty()) return "none: the report is UNSIGNED";
    return listed(record.signatures) + ": whether they hold, `runcert verify` says";
}

Block facts_of(const RunRecord& record) {
    const Attempt& attempt = record.attempt;
    Block told = facts(
        {{"Attempt", attempt.id},
         {"Craft", fmt::format("{}, class {}", claimed(attempt.craft.name), attempt.craft.kind)},
         {"Place", attempt.place.empty() ? "not given" : claimed(attempt.place)},
         {"Date", attempt.date.empty() ? "not given" : attempt.date},
         {"Officials",
          attempt.officials.empty() ? "none named" : officials_text(attempt.officials)}});
    for (const ReceiverResults& one : record.receivers)
        add_fact(told, "Receiver " + one.receiver.id, claimed_value(recording_names(one.receiver)));
    add_fact(told, "Rules claimed under", listed(attempt.profiles));
    if (attempt.record) add_fact(told, "Record to beat", record_text(*attempt.record));
    for (const auto& [profile, beaten] : attempt.records)
        add_fact(told, "Record under " + profile, record_text(beaten));
    add_fact(told, "Report",
             record.report ? "id " + record.report_id : "report.json is not in the folder");
    add_fact(told, "Signatures", signatures_text(record));
    return told;
}

Block makers_of(const std::vector<Product>& products) {
    Block makers =
        table({"stage", "receiver", "file", "program", "source revision"}, "Who made the files");
    for (const Product& product : products) {
        const Header* header = product.header;
        add_row(makers, {product.stage, product.receiver, product.file,
                         header ? "runcert " + header->program_version : "MISSING",
                         header ? header->source_revision : ""});
    }
    return makers;
}

/// What the makers and the files that are there, or not, come to.
std::vector<std::string> findings_of(const std::vector<Product>& products) {
    std::set<std::string> makers;
    std::vector<std::string> missing;
    for (const Product& product : products) {
        if (product.header)
            makers.insert(product.header->program_version + " " + product.header->source_revision);
        else
            missing.push_back(fmt::format("{} ({})", product.file, product.stage));
    }
    std::vector<std::string> findings{
        makers.empty() ? "No file of a stage is there."
        : makers.size() == 1
            ? "All of them were made by the same program."
            : fmt::format("They were made by {} DIFFERENT versions of the program.",
                          makers.size())};
    if (!missing.empty())
        findings.push_back(fmt::format(
            "MISSING from the folder: {}. The walk has nothing to show there, and the hashes that "
            "these files name are not checked.",
            listed(missing)));
    return findings;
}

std::string replaced_text(const Attempt& attempt) {
    if (attempt.overrides.empty() && attempt.rules.empty())
        return "The attempt replaces no parameter and no figure of a rule.";
    std::vector<std::string> figures = attempt.overrides;
    for (const ReplacedFigure& figure : attempt.rules)
        figures.push_back(figure.profile + " " + figure.figure);
    return fmt::format("The attempt replaces {}; the stages below say what by.", listed(figures));
}

/// What the run is, who made its files, and what is missing.
Section run_section(const RunRecord& record, Level level) {
    const std::vector<Product> products = products_of(record);
    std::vector<std::string> findings = findings_of(products);
    findings.push_back(replaced_text(record.attempt));
    findings.emplace_back(
        "Every hash (SHA-256) that one file of the folder names of another that is there was "
        "computed again, and holds.");
    if (level != Level::all)
        findings.emplace_back("Hashes are cut to their first digits (--all: in full).");
    return {.anchor = "run",
            .title = "The run",
            .blocks = {facts_of(record), makers_of(products), list_of(std::move(findings))}};
}

/// "3. screen, receiver primary"
std::string stage_title(const std::string& stage, const std::string& receiver) {
    const auto& stages = audited_stages();
    const auto number = std::find(stages.begin(), stages.end(), stage) - stages.begin() + 1;
    return fmt::format("{}. {}{}", number, stage, receiver.empty() ? "" : ", receiver " + receiver);
}

Section stage_section(const Product& product) {
    Section section{.anchor = product.stage, .title = stage_title(product.stage, product.receiver)};
    if (!product.receiver.empty()) section.anchor += "-" + product.receiver;
    if (!product.header)
        add(section, paragraph(fmt::format("{} is MISSING from the folder: what this stage decided "
                                           "cannot be shown. The walk goes on with what is there.",
                                           product.file)));
    return section;
}

}  // namespace

std::vector<Block> product_blocks(const RunRecord& record, const Header& header,
                                  const std::string& file, const std::string& contents,
                                  Level level) {
    const InputFile& own = *file_in(record, file);
    return {inputs_table(record, header, level),
            facts({{"Went out", fmt::format("{}: {}, {} bytes", file, contents,
                                            counted(static_cast<std::int64_t>(own.bytes)))},
                   {"Its SHA-256", hash_text(own.sha256, level)},
                   {"That hash is named", named_text(record, file)},
                   {"Made by", fmt::format("runcert {}, source {}", header.program_version,
                                           header.source_revision)},
                   {"Schema", header.schema_name + " " + header.schema_version}})};
}

std::optional<RuleView> rule_view(const RunRecord& record, const std::string& profile,
                                  const ProfileWindows* windows) {
    static const ProfileVerdict none;
    const auto rule = std::ranges::find(record.profiles, profile, &Profile::id);
    if (rule == record.profiles.end()) return std::nullopt;
    const ProfileVerdict* verdict = &none;
    if (is_there(record.verdict.header))
        for (const ProfileVerdict& one : record.verdict.profiles)
            if (one.profile == profile) verdict = &one;
    return RuleView{record.attempt, *verdict, *rule, windows};
}

const std::vector<std::string>& audited_stages() {
    static const std::vector<std::string> stages{"import", "enu",    "screen",
                                                 "smooth", "window", "check"};
    return stages;
}

Document walk_through(const RunRecord& record, const WalkOptions& options) {
    Document walk{.title = fmt::format("Audit of the attempt {}", record.attempt.id)};
    const Level level = options.all ? Level::all : Level::record;
    if (options.stages.empty()) walk.sections.push_back(run_section(record, level));
    const std::vector<Product> products = products_of(record);
    for (const std::string& stage : audited_stages()) {
        if (!options.stages.empty() && !options.stages.contains(stage)) continue;
        for (const Product& product : products) {
            const bool asked =
                options.receiver.empty() || !product.of || options.receiver == product.receiver;
            if (product.stage != stage || !asked) continue;
            Section& section = walk.sections.emplace_back(stage_section(product));
            if (product.header)
                add(section, product.of ? product.blocks(record, *product.of, level)
                                        : check_blocks(record, level));
        }
    }
    return walk;
}

}  // namespace runcert
