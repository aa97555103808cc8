#include <fmt/format.h>

#include "trust/bundle.h"
#include "trust/verification.h"

namespace runcert {

std::optional<VerificationStep> verify_bundle(const std::filesystem::path& run_dir) {
    if (!std::filesystem::exists(std::filesystem::symlink_status(run_dir / bundle_sums_file)))
        return std::nullopt;
    VerificationStep step{.passed = true, .what = "bundle", .finding = {}, .details = {}};
    for (const SumProblem& one : check_sums(run_dir)) {
        step.passed = false;
        step.details.push_back(one.file + " " + one.problem);
    }
    step.finding = fmt::format("the files are {}those that the bundle's {} lists",
                               step.passed ? "" : "not ", bundle_sums_file);
    if (std::filesystem::exists(run_dir / bundle_keys_folder))
        step.details.emplace_back(
            "The keys in it are the sender's word: one counts where you give it yourself.");
    return step;
}

}  // namespace runcert
