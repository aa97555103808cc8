#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "schemas/common/document.h"
#include "schemas/common/product_files.h"
#include "schemas/products/products.h"
#include "schemas/verdict/declared.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "store/yaml_output.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// Collects what is wrong, a line for each file.
struct Findings {
    std::size_t read = 0;
    std::vector<std::string> faults{};

    template <class Check>
    void check(const std::string& name, const Check& body) {
        try {
            body();
            ++read;
        } catch (const Failure& failure) {
            faults.push_back(fmt::format("{}: {}", shown(name), failure.problem()));
        }
    }
};

/// One program makes a whole run. A file that says otherwise came from elsewhere, or was made to
/// look older than the report.
void refuse_other_program(const Header& header, const ReportFacts& report,
                          const std::string& name) {
    if (header.program_version == report.program_version &&
        header.source_revision == report.source_revision)
        return;
    throw Failure(
        name,
        fmt::format(
            "its header says that runcert {} ({}) made it, the report that {} ({}) "
            "made it: it is of another run, or was changed",
            escape_for_message(header.program_version), escape_for_message(header.source_revision),
            escape_for_message(report.program_version), escape_for_message(report.source_revision)),
        "Take the original, or certify again");
}

void check_stage_file(const fs::path& file, const ReportFacts& report) {
    const std::string name = file.filename().string();
    const FileView view(file);
    const std::string_view text = view.bytes();
    const Header header = read_product_header(text, name, file.string());
    check_product(text, name, file.string());
    refuse_other_program(header, report, name);
}

void check_attempt_files(const fs::path& run_dir, Findings& findings) {
    const std::string name(attempt_copy_name);
    const fs::path file = run_dir / name;
    if (!fs::is_regular_file(fs::symlink_status(file))) return;
    std::optional<Attempt> attempt;
    findings.check(name, [&] { attempt = read_attempt(read_handwritten(file), file.string()); });
    if (!attempt) return;
    for (const std::string& claimed : attempt->profiles)
        if (const std::string profile = profile_copy_name(claimed);
            fs::is_regular_file(fs::symlink_status(run_dir / profile)))
            findings.check(profile, [&, copy = run_dir / profile] {
                (void)with_replaced_figures(read_profile(read_handwritten(copy), copy.string()),
                                            *attempt);
            });
}

/// The rule that a verdict says it went by must be the text in the folder.
void compare_identity(const Profile& rule, const Verdict& verdict, VerificationStep& step) {
    const auto judged = std::ranges::find(verdict.profiles, rule.id, &ProfileVerdict::profile);
    if (judged != verdict.profiles.end() && judged->rule.revision == rule.revision &&
        judged->rule.sha256 == rule.sha256 && judged->rule.origin == rule.origin)
        return;
    step.fail(fmt::format("{}: {} was not decided by this text of the rule",
                          shown(profile_copy_name(rule.id)), products::verdict_file));
}

void check_rules(const fs::path& run_dir, VerificationStep& step) {
    const fs::path file = run_dir / attempt_copy_name;
    const Attempt attempt = read_attempt(read_handwritten(file), file.string());
    const fs::path judged = run_dir / products::verdict_file;
    const Verdict verdict = read_verdict(read_file(judged), judged.string());
    std::vector<std::string> own;
    for (const std::string& claimed : attempt.profiles) {
        const Profile rule = read_claimed_profile(run_dir, claimed, attempt);
        if (!rule.evidence) compare_identity(rule, verdict, step);
        if (rule.origin == RuleOrigin::own) own.push_back(shown(rule.id));
        step.details.push_back(fmt::format(
            "{}: revision {}, SHA-256 {}{}{}", shown(profile_copy_name(rule.id)), rule.revision,
            rule.sha256.substr(0, 16),
            rule.origin == RuleOrigin::own ? ", the attempt's own: no body's authority for it was "
                                             "checked"
            : rule.overrides.empty()       ? ""
                                           : ", with figures replaced by the attempt",
            rule.origin == RuleOrigin::own || rule.superseded_by.empty()
                ? ""
                : fmt::format("; {} has superseded it", rule.superseded_by)));
    }
    if (!step.is(LayerAnswer::verified))
        step.finding = "the outcome does not rest on the rules in the folder";
    else if (own.empty())
        step.finding = "every rule is one that comes with the program";
    else
        step.finding = fmt::format("the attempt's own, not a body's: {}", listed(own));
}

}  // namespace

void require_known_versions(const fs::path& run_dir) {
    if (!fs::is_directory(run_dir)) return;
    const auto is_there = [&](const std::string& name) {
        return fs::is_regular_file(fs::symlink_status(run_dir / name));
    };
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(run_dir))
        names.insert(entry.path().filename().string());
    for (const std::string& name : names) {
        if (!is_there(name)) continue;
        const fs::path file = run_dir / name;
        if (is_product_name(name))
            require_known_version(FileView(file).bytes(), name, file.string());
        else if (name == attempt_copy_name)
            (void)parse_input(read_handwritten(file), file.string(), attempt_schema());
        else if (name.starts_with("profile.") && name.ends_with(".yaml"))
            (void)parse_input(read_handwritten(file), file.string(), profile_schema());
        else if (name == "report.json")
            (void)read_report_facts(run_dir);
    }
}

VerificationStep verify_schemas(const fs::path& run_dir, const ReportFacts& report) {
    Findings findings;
    const std::string where = (run_dir / "report.json").string();
    // JSON is YAML.
    findings.check("report.json", [&] {
        const nlohmann::ordered_json predicate = report.json->at("predicate");
        check_document(YamlValue(yaml_node_of(predicate), where), report_field_table());
    });
    check_attempt_files(run_dir, findings);
    for (const auto& [name, sha256] : report.subjects)
        if (is_product_name(name) && fs::is_regular_file(fs::symlink_status(run_dir / name)))
            findings.check(name, [&, file = run_dir / name] { check_stage_file(file, report); });
    const bool passed = findings.faults.empty();
    return {.what = "schemas",
            .answer = passed ? LayerAnswer::verified : LayerAnswer::not_verified,
            .finding = passed
                           ? fmt::format("all {} documents follow schemas that this program knows",
                                         findings.read)
                           : "not every document follows a schema that this program knows",
            .details = findings.faults};
}

VerificationStep verify_rules(const fs::path& run_dir) {
    VerificationStep step{.what = "rules", .answer = LayerAnswer::verified};
    try {
        check_rules(run_dir, step);
    } catch (const Failure& failure) {
        step.finding = "not every rule is what it says it is";
        step.fail(failure);
    }
    return step;
}

}  // namespace runcert
