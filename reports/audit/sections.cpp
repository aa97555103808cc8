#include "reports/audit/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/claimed_text.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/words/attempt.h"
#include "schemas/common/product_files.h"

namespace runcert {

namespace {

/// A hash, in full or by as many of its digits as tell it from others.
std::string hash_text(const std::string& sha256, Level level) {
    return level == Level::all ? sha256 : sha256.substr(0, 12);
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
    PartOf* part = nullptr;
    const ReceiverResults* of = nullptr;
    std::string heading = {};  ///< of what stands beside another product of its stage; else empty
};

/// Of what stands beside another product those of which both are there.
std::vector<Product> products_of(const RunRecord& record) {
    std::vector<Product> products;
    const auto there = [](const Header& header) { return is_there(header) ? &header : nullptr; };
    for (const ReceiverResults& one : record.receivers) {
        const auto add = [&](const std::string& stage, const char* name, const Header& header,
                             PartOf* part, const std::string& title = {}) {
            products.push_back(
                {stage, one.receiver.id, one.files.at(name), there(header), part, &one, title});
        };
        const auto add_beside = [&](const char* title, const char* name, const auto& table,
                                    PartOf* part) {
            if (table && products.back().header)
                add(products.back().stage, name, table->header, part, title);
        };
        add("import", "observations", one.observations.header, observations_part);
        add_beside("Raw phases", "phase", one.phase, phase_part);
        add_beside("IMU", "imu", one.imu, imu_part);
        add_beside("Surface", "surface", one.surface, surface_part);
        add("enu", "enu", one.enu.header, enu_part);
        add("screen", "screened", one.screened.header, screened_part);
        add_beside("Carrier phases", "screened_phase", one.screened_phase, screened_phase_part);
        add("smooth", "trajectory", one.trajectory.header, trajectory_part);
        add_beside("Attitude", "attitude", one.attitude, attitude_part);
        add("window", "windows", one.windows.header, windows_part);
    }
    products.push_back({"check",
                        {},
                        std::string(products::verdict_file),
                        there(record.verdict.header),
                        verdict_part,
                        &record.receivers.front()});
    products.push_back({"report", {}, "report.json", record.report ? &*record.report : nullptr});
    return products;
}

/// Where a product comes from and what became of it, as a table of its inputs and the facts of its
/// own file; and what is told of it.
void add_product(Section& section, const RunRecord& record, const Product& product, Level level) {
    const Header& header = *product.header;
    ProductPart part = product.part(record, *product.of, level);
    const InputFile& own = *file_in(record, product.file);
    if (!product.heading.empty()) add(section, heading(product.heading));
    add(section, inputs_table(record, header, level));
    add(section, facts({{"Went out", fmt::format("{}: {}, {} bytes", product.file, part.contents,
                                                 counted(static_cast<std::int64_t>(own.bytes)))},
                        {"Its SHA-256", hash_text(own.sha256, level)},
                        {"That hash is named", named_text(record, product.file)},
                        {"Made by", fmt::format("runcert {}, source {}", header.program_version,
                                                header.source_revision)},
                        {"Schema", header.schema_name + " " + header.schema_version}}));
    add(section, std::move(part.blocks));
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
    Block block = facts(
        {{"Attempt", attempt.id},
         {"Craft", fmt::format("{}, class {}", claimed(attempt.craft.name), attempt.craft.kind)},
         {"Place", attempt.place.empty() ? "not given" : claimed(attempt.place)},
         {"Date", attempt.date.empty() ? "not given" : attempt.date},
         {"Officials",
          attempt.officials.empty() ? "none named" : officials_text(attempt.officials)}});
    for (const ReceiverResults& one : record.receivers)
        add_fact(block, "Receiver " + one.receiver.id,
                 claimed_value(recording_names(one.receiver)));
    add_fact(block, "Rules claimed under", listed(attempt.profiles));
    if (attempt.record) add_fact(block, "Record to beat", record_text(*attempt.record));
    for (const auto& [profile, beaten] : attempt.records)
        add_fact(block, "Record under " + profile, record_text(beaten));
    add_fact(block, "Report",
             record.report ? "id " + record.report_id : "report.json is not in the folder");
    add_fact(block, "Signatures", signatures_text(record));
    return block;
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
    std::vector<Product> products = products_of(record);
    std::erase_if(products, [](const Product& product) { return !product.heading.empty(); });
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

/// The beginning of a section: "3. screen, receiver primary".
Section stage_section(const Product& product) {
    const auto& stages = audited_stages();
    const auto number = std::ranges::find(stages, product.stage) - stages.begin() + 1;
    Section section{.anchor = product.stage, .title = fmt::format("{}. {}", number, product.stage)};
    if (!product.receiver.empty()) {
        section.anchor += "-" + product.receiver;
        section.title += ", receiver " + product.receiver;
    }
    if (!product.header)
        add(section, paragraph(fmt::format("{} is MISSING from the folder: what this stage decided "
                                           "cannot be shown. The walk goes on with what is there.",
                                           product.file)));
    return section;
}

}  // namespace

bool holds_nothing(const RunRecord& record) {
    return std::ranges::none_of(products_of(record),
                                [](const Product& one) { return one.header != nullptr; });
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
        if (!options.stages.empty() &&
            std::ranges::find(options.stages, stage) == options.stages.end())
            continue;
        for (const Product& product : products) {
            const bool asked = options.receiver.empty() || product.receiver.empty() ||
                               options.receiver == product.receiver;
            if (product.stage != stage || !asked) continue;
            if (product.heading.empty()) walk.sections.push_back(stage_section(product));
            if (product.header) add_product(walk.sections.back(), record, product, level);
        }
    }
    return walk;
}

}  // namespace runcert
