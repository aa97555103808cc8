#include "trust/signable.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/failure.h"
#include "core/plain_text.h"
#include "files/atomic_file.h"
#include "reports/words/figures.h"
#include "reports/words/outcome.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/verdict.h"

namespace runcert {

void require_passed(const std::filesystem::path& run_dir, const VerificationStep& step,
                    const std::string& remedy) {
    if (step.passed) return;
    throw Failure(run_dir.string(),
                  fmt::format("{}{}{}", step.finding, step.details.empty() ? "" : ": ",
                              fmt::join(step.details, "; ")),
                  "Nothing was signed. " + remedy);
}

void require_signable(const std::filesystem::path& run_dir, const ReportFacts& report,
                      const std::string& remedy) {
    require_passed(run_dir, verify_files(run_dir, report), remedy);
    require_passed(run_dir, verify_chain(run_dir, report), remedy);
    require_passed(run_dir, verify_schemas(run_dir, report), remedy);
    require_passed(run_dir, verify_rules(run_dir), remedy);
    require_passed(run_dir, verify_report(run_dir, report), remedy);
}

std::vector<std::string> what_is_signed(const std::filesystem::path& run_dir) {
    const std::filesystem::path file = run_dir / products::verdict_file;
    std::vector<std::string> lines;
    for (const ProfileVerdict& verdict : read_verdict(read_file(file), file.string()).profiles)
        lines.push_back(plain_text(fmt::format(
            "{}: {}{}", rule_identity_text(verdict),
            verdict.shown ? measured_speed_text(*verdict.shown, verdict.coverage_factor) + "; "
                          : std::string(),
            outcome_words(state_of(verdict)).title)));
    return lines;
}

}  // namespace runcert
