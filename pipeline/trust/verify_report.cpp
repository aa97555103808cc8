#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/steps.h"
#include "schemas/common/members.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "store/sha256.h"
#include "store/yaml_input.h"
#include "trust/verification.h"

// report.json against the files that it vouches for: whoever signs it may have written it by hand.

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string verdict_file(products::verdict_file);

/// The report writes speeds with 4 decimals or more, from a verdict of 4 decimals of 1 km/h.
constexpr double speed_resolution = 2e-4;  // in each unit

/// Compares what a report says with what a file says; notes what differs.
class Comparison {
  public:
    explicit Comparison(VerificationStep& step) : step_(step) {}

    void fail(std::string detail) { step_.fail(std::move(detail)); }
    void equal(const std::string& what, const std::string& in_report, const std::string& in_file,
               const std::string& file) {
        if (in_report != in_file)
            fail(fmt::format("report.json: {} is \"{}\", in {} it is \"{}\"", what,
                             shown(in_report), file, shown(in_file)));
    }
    void number(const std::string& what, const std::optional<double>& in_report,
                const std::optional<double>& in_file, const std::string& file) {
        const auto words = [](const std::optional<double>& value) {
            return value ? fmt::format("{}", *value) : std::string("absent");
        };
        const bool same = in_report.has_value() == in_file.has_value() &&
                          (!in_report || std::abs(*in_report - *in_file) <= speed_resolution);
        if (!same)
            fail(fmt::format("report.json: {} is {}, in {} it is {}", what, words(in_report), file,
                             words(in_file)));
    }

  private:
    VerificationStep& step_;
};

std::string text_of(const Json& object, const std::string& key) {
    return object.contains(key) ? object.at(key).get<std::string>() : "";
}

std::optional<double> number_of(const Json& object, const std::string& key) {
    if (!object.contains(key)) return std::nullopt;
    return object.at(key).get<double>();
}

/// The figures as they are to be read.
void compare_shown(const std::string& rule, const Json& profile, const YamlValue& verdict,
                   Comparison& compare) {
    const YamlValue figures = verdict["shown"];
    if (!figures.exists()) return;
    const Json in_report = profile.value("shown", Json::object());
    for (const char* key :
         {"speed", "unit", "expanded_uncertainty", "required_speed", "acceptance_limit"})
        compare.equal(fmt::format("{}, {}", rule, key), text_of(in_report, key),
                      figures[key].text_or(""), verdict_file);
}

/// The block of the document in that place; an empty one where there is none.
Json block_in(const Json& predicate, const std::string& slot) {
    for (const Json& section : predicate.at("document").at("sections"))
        for (const Json& block : section.at("blocks"))
            if (text_of(block, "slot") == slot) return block;
    return Json::object();
}

/// The title of the outcome is what a page shows largest.
void compare_title(const std::string& rule, const Json& predicate, const YamlValue& verdict,
                   Comparison& compare) {
    const YamlValue standing = verdict["standing"];
    const OutcomeState state{.outcome = member::read<Outcome>(verdict["outcome"]),
                             .standing = {.state = member::read<StandingState>(standing["state"]),
                                          .attestations = standing["attestations"].integer(),
                                          .signatures = standing["signatures"].integer()},
                             .record_named = verdict["record"].exists(),
                             .rule_altered = !verdict["overrides"].list().empty() ||
                                             member::read<RuleOrigin>(verdict["rule"]["origin"]) !=
                                                 RuleOrigin::built_in};
    const OutcomeWords words = outcome_words(state);
    const auto equal = [&](const char* what, const std::string& in_report,
                           const std::string& text) {
        compare.equal(fmt::format("{}, {}", rule, what), in_report, text,
                      verdict_file + " (by its outcome)");
    };
    const Json block = block_in(predicate, "outcome/" + verdict["profile"].text());
    const bool several = predicate.at("profiles").size() > 1;
    equal("outcome_title", text_of(block, "text"),
          several ? fmt::format("{}: {}", verdict["profile"].text(), words.title) : words.title);
    equal("outcome_mark", text_of(block, "sign"), words.mark);
    equal("tone", text_of(block, "look"), several ? "strong" : "outcome_" + words.tone);
}

/// The figure that a page shows largest: where a rule alone is claimed, and the record is beaten.
void compare_headline(const Json& predicate, const std::vector<YamlValue>& verdicts,
                      Comparison& compare) {
    std::string headlines;
    for (const Json& section : predicate.at("document").at("sections"))
        for (const Json& block : section.at("blocks"))
            if (text_of(block, "kind") == "headline") headlines += text_of(block, "text");
    const YamlValue figures = verdicts.front()["shown"];
    const bool is_shown = verdicts.size() == 1 && figures.exists() &&
                          member::read<Outcome>(verdicts.front()["outcome"]) == Outcome::beaten;
    compare.equal("its headline", headlines,
                  is_shown ? measured_speed_text(
                                 {.unit = figures["unit"].text(),
                                  .speed = figures["speed"].text(),
                                  .expanded_uncertainty = figures["expanded_uncertainty"].text()})
                           : "",
                  verdict_file + " (by its figures)");
}

/// How sure the outcome is.
void compare_decision(const std::string& rule, const Json& profile, const YamlValue& verdict,
                      Comparison& compare) {
    const Json stated = profile.value("decision", Json::object());
    const YamlValue decision = verdict["decision"];
    for (const char* key : {"probability", "level"})
        compare.number(fmt::format("{}, decision.{}", rule, key), number_of(stated, key),
                       decision.exists() ? decision[key].optional_real() : std::optional<double>(),
                       verdict_file);
}

/// `predicate` has the document in which the profile is shown.
void compare_profile(const Json& predicate, const Json& profile, const YamlValue& verdict,
                     Comparison& compare) {
    const std::string rule = shown(verdict["profile"].text());
    for (const char* key : {"profile", "outcome", "reason", "definition"})
        compare.equal(fmt::format("{}, {}", rule, key), text_of(profile, key), verdict[key].text(),
                      verdict_file);
    compare_title(rule, predicate, verdict, compare);
    for (const char* quantity : {"speed", "expanded_uncertainty", "required_speed"})
        for (const char* unit : {"km_h", "m_s", "knots", "mph"}) {
            const std::string key = fmt::format("{}_{}", quantity, unit);
            compare.number(fmt::format("{}, {}", rule, key), number_of(profile, key),
                           verdict[key].optional_real(), verdict_file);
        }
    compare.number(rule + ", coverage_factor", number_of(profile, "coverage_factor"),
                   verdict["coverage_factor"].optional_real(), verdict_file);
    compare_shown(rule, profile, verdict, compare);
    compare_decision(rule, profile, verdict, compare);
    const auto requirements = verdict["requirements"].list();
    const Json& stated = profile.at("requirements");
    if (requirements.size() != stated.size())
        return compare.fail(fmt::format("report.json: {} has {} requirements, in {} it has {}",
                                        rule, stated.size(), verdict_file, requirements.size()));
    for (std::size_t i = 0; i < requirements.size(); ++i)
        for (const char* key : {"clause", "status", "evidence"})
            compare.equal(fmt::format("{}, requirement {}, {}", rule, i + 1, key),
                          text_of(stated.at(i), key), requirements[i][key].text(), verdict_file);
}

void compare_verdict(const fs::path& run_dir, const ReportFacts& report, Comparison& compare) {
    const std::string where = (run_dir / verdict_file).string();
    const YamlValue verdict(parse_yaml(read_file(where), where), where);
    compare.equal("the attempt's id", report.attempt_id, verdict["attempt"].text(), verdict_file);
    const Json& whole = report.json->at("predicate");
    for (const char* const list : {"profiles", "with_files"}) {
        const auto verdicts =
            verdict[list].exists() ? verdict[list].list() : std::vector<YamlValue>{};
        const bool with_files = list != std::string_view("profiles");
        const Json predicate =
            with_files ? whole.value("with_files", Json{{"profiles", Json::array()}}) : whole;
        const Json& profiles = predicate.at("profiles");
        if (verdicts.size() != profiles.size())
            return compare.fail(fmt::format("report.json: it has results by {} rules, {} has {}",
                                            profiles.size(), verdict_file, verdicts.size()));
        if (!verdicts.empty()) compare_headline(predicate, verdicts, compare);
        for (std::size_t i = 0; i < verdicts.size(); ++i)
            compare_profile(predicate, profiles.at(i), verdicts[i], compare);
    }
}

/// The signatures that rules and attempt ask for: a report cannot ask for fewer.
void compare_required(const fs::path& run_dir, const ReportFacts& report, const Attempt& attempt,
                      Comparison& compare) {
    std::vector<RoleSignatures> needed;
    for (Profile& rule : read_claimed_rules(run_dir, attempt))
        needed = combined(std::move(needed), rule.signatures);
    for (const RoleSignatures& one : combined(std::move(needed), attempt.signatures)) {
        std::int64_t stated = 0;
        for (const RequiredSignatures& required : report.required)
            if (required.role == one.role) stated += static_cast<std::int64_t>(required.count);
        if (stated < one.count)
            compare.fail(
                fmt::format("report.json: asks for {} signatures in the role {}, attempt "
                            "and rules ask for {}",
                            stated, one.role, one.count));
    }
}

/// Attempt, recordings, rules, and what each stage made of them: all of them, and nothing else.
void compare_subjects(const ReportFacts& report, const RunInventory& inventory,
                      Comparison& compare) {
    for (const std::string& file : inventory.files)
        if (!report.subjects.contains(file))
            compare.fail(
                fmt::format("{}: the attempt needs it, the report does not name it", shown(file)));
    for (const auto& [file, sha256] : report.subjects)
        if (std::ranges::find(inventory.files, file) == inventory.files.end())
            compare.fail(fmt::format("{}: the report names it, nothing in the attempt asks for it",
                                     shown(file)));
    std::string lines;
    for (const std::string& name : report.subject_names)
        lines += fmt::format("{}  {}\n", report.subjects.at(name), name);
    constexpr std::size_t id_digits = 16;
    compare.equal("its id", report.report_id, sha256_hex(lines).substr(0, id_digits),
                  "the list of its files");
}

void compare_all(const fs::path& run_dir, const ReportFacts& report, Comparison& compare) {
    const std::string file(attempt_copy_name);
    if (!report.subjects.contains(file))
        return compare.fail("attempt.yaml: the report does not name it, and says nothing without");
    const Attempt attempt =
        read_attempt(read_handwritten(run_dir / file), (run_dir / file).string());
    compare.equal("the attempt's id", report.attempt_id, attempt.id, file);
    compare_subjects(report, inventory_of(attempt), compare);
    compare_required(run_dir, report, attempt, compare);
    compare_verdict(run_dir, report, compare);
}

}  // namespace

VerificationStep verify_report(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{.what = "report", .answer = LayerAnswer::verified};
    Comparison compare(step);
    try {
        compare_all(run_dir, report, compare);
    } catch (const Failure& failure) {
        step.fail(failure);
    } catch (const Json::exception& error) {
        compare.fail("report.json: cannot be read: " + shown(error.what()));
    }
    if (!report.program_home.empty() && report.program_home != program_home())
        step.details.push_back(
            fmt::format("note: it says that its program is to be had at {}; of this one, {}",
                        report.program_home,
                        *program_home() == '\0' ? "nothing is said"
                                                : std::string(program_home()) + " is said"));
    step.finding = step.is(LayerAnswer::verified)
                       ? "outcome, speeds and limits are those of 6-verdict.yaml, the files "
                         "are those that the attempt asks for"
                       : "it does not say what its files say";
    return step;
}

}  // namespace runcert
