#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "run/attempt_files.h"
#include "schemas/common/product_files.h"
#include "schemas/products/products.h"
#include "schemas/verdict/verdict.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// The rule that a verdict says it went by must be the text in the folder.
void compare_identity(const Profile& rule, const Verdict& verdict, VerificationStep& step) {
    const auto judged = std::ranges::find(verdict.profiles, rule.id, &ProfileVerdict::profile);
    if (judged != verdict.profiles.end() && judged->rule.revision == rule.revision &&
        judged->rule.sha256 == rule.sha256 && judged->rule.origin == rule.origin)
        return;
    step.passed = false;
    step.details.push_back(fmt::format("{}: {} was not decided by this text of the rule",
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
        compare_identity(rule, verdict, step);
        if (rule.origin == RuleOrigin::own) own.push_back(shown(rule.id));
        step.details.push_back(fmt::format(
            "{}: revision {}, SHA-256 {}{}", shown(profile_copy_name(rule.id)), rule.revision,
            rule.sha256.substr(0, 16),
            rule.origin == RuleOrigin::own ? ", the attempt's own: no body's authority for it was "
                                             "checked"
            : rule.overrides.empty()       ? ""
                                           : ", with figures replaced by the attempt"));
    }
    if (!step.passed)
        step.finding = "the outcome does not rest on the rules in the folder";
    else if (own.empty())
        step.finding = "every rule is one that comes with the program";
    else
        step.finding = fmt::format("the attempt's own, not a body's: {}", listed(own));
}

}  // namespace

VerificationStep verify_rules(const fs::path& run_dir) {
    VerificationStep step{.passed = true, .what = "rules", .finding = {}, .details = {}};
    try {
        check_rules(run_dir, step);
    } catch (const Failure& failure) {
        step.passed = false;
        step.finding = "not every rule is what it says it is";
        step.details.push_back(fmt::format(
            "{}: {}", shown(fs::path(failure.where()).filename().string()), failure.problem()));
    }
    return step;
}

}  // namespace runcert
