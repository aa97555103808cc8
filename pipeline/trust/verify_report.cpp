#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/steps.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "store/sha256.h"
#include "trust/verification.h"

// report.json against the files that it vouches for: whoever signs it may have written it by hand.

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string verdict_file(products::verdict_file);

/// Compares what a report says with what a file says; notes what differs.
class Comparison {
  public:
    explicit Comparison(VerificationStep& step) : step_(step) {}

    void fail(std::string detail) { step_.fail(std::move(detail)); }
    void equal(const std::string& what, const std::string& in_report, const std::string& in_file,
               const std::string& file) {
        if (in_report != in_file) differs(what, in_report, in_file, file);
    }
    void differs(const std::string& what, const std::string& in_report, const std::string& in_file,
                 const std::string& file) {
        fail(fmt::format("report.json: {} is \"{}\", in {} it is \"{}\"", what, shown(in_report),
                         file, shown(in_file)));
    }

  private:
    VerificationStep& step_;
};

std::string text_of(const Json& object, const std::string& key) {
    return object.contains(key) ? object.at(key).get<std::string>() : "";
}

/// What a map holds under that name; null where it has nothing there.
const Json* member_of(const Json& map, const std::string& name) {
    const auto found = map.find(name);
    return found == map.end() ? nullptr : &*found;
}

std::string words_of(const Json* value) {
    if (value == nullptr) return "absent";
    if (value->is_string()) return value->get<std::string>();
    if (!value->is_structured()) return value->dump();
    return fmt::format("a {} of {}", value->is_array() ? "list" : "map", value->size());
}

/// Every value of the verdict that the report holds otherwise than the file; null where one of the
/// two has none.
void compare_values(const std::string& path, const Json* in_report, const Json* in_file,
                    Comparison& compare) {
    const auto below = [&](const std::string& name) { return path + "." + name; };
    const bool both = in_report != nullptr && in_file != nullptr;
    if (both && in_report->is_object() && in_file->is_object()) {
        for (const auto& [key, value] : in_file->items())
            compare_values(below(key), member_of(*in_report, key), &value, compare);
        for (const auto& [key, value] : in_report->items())
            if (!in_file->contains(key)) compare_values(below(key), &value, nullptr, compare);
    } else if (both && in_report->is_array() && in_file->is_array() &&
               in_report->size() == in_file->size()) {
        for (std::size_t i = 0; i < in_file->size(); ++i)
            compare_values(below(std::to_string(i)), &(*in_report)[i], &(*in_file)[i], compare);
    } else if (!both || *in_report != *in_file) {
        compare.differs(path, words_of(in_report), words_of(in_file), verdict_file);
    }
}

/// The block of the document in that place; an empty one where there is none.
Json block_in(const Json& predicate, const std::string& slot) {
    for (const Json& section : predicate.at("document").at("sections"))
        for (const Json& block : section.at("blocks"))
            if (text_of(block, "slot") == slot) return block;
    return Json::object();
}

/// The title of the outcome is what a page shows largest. `shown` holds its document.
void compare_title(const Json& shown, const ProfileVerdict& rule, bool several,
                   Comparison& compare) {
    const OutcomeWords words = outcome_words(state_of(rule));
    const auto equal = [&](const char* what, const std::string& in_report,
                           const std::string& text) {
        compare.equal(fmt::format("{}, {}", rule.profile, what), in_report, text,
                      verdict_file + " (by its outcome)");
    };
    const Json block = block_in(shown, "outcome/" + rule.profile);
    equal("outcome_title", text_of(block, "text"),
          several ? fmt::format("{}: {}", rule.profile, words.title) : words.title);
    equal("outcome_mark", text_of(block, "sign"), words.mark);
    equal("tone", text_of(block, "look"), several ? "strong" : "outcome_" + words.tone);
}

/// The figure that a page shows largest: where a rule alone is claimed, and the record is beaten.
void compare_headline(const Json& shown, const std::vector<ProfileVerdict>& rules,
                      Comparison& compare) {
    std::string headlines;
    for (const Json& section : shown.at("document").at("sections"))
        for (const Json& block : section.at("blocks"))
            if (text_of(block, "kind") == "headline") headlines += text_of(block, "text");
    const ProfileVerdict& first = rules.front();
    const bool is_shown = rules.size() == 1 && first.shown && first.outcome == Outcome::beaten;
    compare.equal("its headline", headlines, is_shown ? measured_speed_text(*first.shown) : "",
                  verdict_file + " (by its figures)");
}

void compare_document(const Json& shown, const std::vector<ProfileVerdict>& rules,
                      Comparison& compare) {
    compare_headline(shown, rules, compare);
    for (const ProfileVerdict& rule : rules)
        compare_title(shown, rule, rules.size() > 1, compare);
}

void compare_verdict(const fs::path& run_dir, const ReportFacts& report, Comparison& compare) {
    const std::string where = (run_dir / verdict_file).string();
    const std::string text = read_file(where);
    const Verdict verdict = read_verdict(text, where);
    const Json& predicate = report.json->at("predicate");
    compare.equal("the attempt's id", report.attempt_id, verdict.attempt, verdict_file);
    const Json in_file = body_of(text, where);
    compare_values("verdict", &predicate.at("verdict"), &in_file, compare);
    compare_document(predicate, verdict.profiles, compare);
    if (!verdict.with_files.empty())
        compare_document(predicate.at("with_files"), verdict.with_files, compare);
    else if (predicate.contains("with_files"))
        compare.fail("report.json: it shows what second files change, " + verdict_file +
                     " has nothing of it");
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
