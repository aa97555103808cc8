#include "recompute.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "run/chain.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/process.h"
#include "store/program.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// The files that stages write, in the order of the chain, those of both folders.
std::set<std::string> products_of(const fs::path& a, const fs::path& b) {
    std::set<std::string> names;
    for (const fs::path& folder : {a, b})
        for (const auto& entry : fs::directory_iterator(folder))
            if (const std::string name = entry.path().filename(); is_product_name(name))
                names.insert(name);
    return names;
}

/// What came of running the stages again.
struct Recomputation {
    std::string failed{};        ///< what a stage said that could not be run; empty where all ran
    std::string not_imported{};  ///< why import was left out, and its files taken as they are
};

/// All stages' files again. Where import needs a program that is not here, the later stages' from
/// what the folder's import made.
Recomputation recompute(const fs::path& run_dir, const fs::path& folder) {
    const fs::path file = run_dir / attempt_copy_name;
    const std::string text = read_handwritten(file);
    const Attempt attempt = read_attempt(text, file.string());
    const RunInMaking run{.attempt = attempt,
                          .text = text,
                          .source = {.file = file, .earlier_run = run_dir},
                          .folder = folder,
                          .known_as = run_dir};
    Recomputation result;
    const auto make = [&](const std::vector<std::string>& left_out) {
        const auto stays = [&](const Step& step) {
            return (step.products.empty() && step.name != "claim") ||
                   std::ranges::find(left_out, step.name) != left_out.end();
        };
        make_run(run, stays, [](const StageDone&) {});
    };
    try {
        try {
            make({});
        } catch (const StageFailed& failed) {
            const auto program = failed_call(failed);
            if (failed.name != "import" || !program) throw;
            result.not_imported = missing_program_words(*program);
            if (result.not_imported.empty()) throw;
            for (const std::string& name : outputs_of(step_named("import"), attempt, {}))
                if (fs::is_regular_file(fs::symlink_status(run_dir / name)))
                    fs::copy_file(run_dir / name, folder / name,
                                  fs::copy_options::overwrite_existing);
            make({"claim", "import"});
        }
    } catch (const StageFailed& failed) {
        result.failed = failed.name + ": " + message_of(failed);
    }
    return result;
}

/// report.json again, from the stage files of the run folder itself: where those are as good as
/// the recomputed ones, it must follow from them to the letter, on any processor.
std::optional<std::string> recompute_report(const fs::path& run_dir, const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(run_dir))
        if (const std::string name = entry.path().filename().string();
            entry.is_regular_file() && !name.starts_with("report.") && !is_page_name(name))
            fs::copy_file(entry.path(), folder / entry.path().filename());
    try {
        run_step("report", {.attempt = folder / "attempt.yaml", .run_dir = folder});
    } catch (const StageFailed& failed) {
        return message_of(failed);
    }
    return std::nullopt;
}

/// What comparing all files gave.
struct Comparisons {
    std::size_t files = 0;
    std::size_t identical = 0;
    std::vector<FileComparison> different;  ///< beyond the tolerance, in the order of the chain
    std::optional<FileComparison> widest;   ///< of the largest ratio among the others
    std::vector<std::string> makers;        ///< of the folder's files, where not this program
};

Comparisons compare_all(const fs::path& run_dir, const fs::path& recomputed, bool same_arithmetic) {
    Comparisons all;
    for (const std::string& name : products_of(recomputed, run_dir)) {
        FileComparison file = compare_file(run_dir, recomputed, name, same_arithmetic);
        ++all.files;
        if (!file.maker.empty() && std::ranges::find(all.makers, file.maker) == all.makers.end())
            all.makers.push_back(file.maker);
        if (file.identical)
            ++all.identical;
        else if (file.first)
            all.different.push_back(std::move(file));
        else if (!all.widest || file.largest_ratio > all.widest->largest_ratio)
            all.widest = std::move(file);
    }
    return all;
}

std::string finding_of(const Comparisons& all) {
    const std::string count = fmt::format("{} of {} files byte for byte", all.identical, all.files);
    if (!all.different.empty())
        return fmt::format("different, first at the stage {}: {}", all.different.front().stage,
                           all.different.front().sentence());
    if (all.identical == all.files)
        return fmt::format("identical: all {} files, byte for byte", all.files);
    const std::string largest =
        all.widest && all.widest->largest_ratio > 0.0
            ? fmt::format("the largest difference is {:.2g} of it ({})", all.widest->largest_ratio,
                          all.widest->where_largest)
            : "no value differs by more than its last digits";
    return fmt::format("equal within 1/1000 of the stated uncertainty: {}, {}", count, largest);
}

}  // namespace

VerificationStep verify_recomputation(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{.what = "recompute"};
    const TemporaryFolder folder;
    const Recomputation done = recompute(run_dir, folder.path());
    if (!done.failed.empty()) {
        step.finding = "the stages cannot be run on the folder's files";
        step.fail(done.failed);
        return step;
    }
    const bool same_arithmetic = report.arithmetic == arithmetic_fingerprint();
    const Comparisons all = compare_all(run_dir, folder.path(), same_arithmetic);
    step.answer = !all.different.empty()       ? LayerAnswer::not_verified
                  : !done.not_imported.empty() ? LayerAnswer::not_checkable
                                               : LayerAnswer::verified;
    step.finding = plain_text(finding_of(all));
    if (step.is(LayerAnswer::not_checkable))
        step.finding = fmt::format("import not checked here: {}. From its files on: {}",
                                   done.not_imported, step.finding);
    for (std::size_t i = 1; i < all.different.size(); ++i)
        step.details.push_back(plain_text("also " + all.different[i].sentence()));
    if (step.is(LayerAnswer::not_verified))
        step.details.push_back(fmt::format("{} of {} files are identical, {} within the tolerance",
                                           all.identical, all.files,
                                           all.files - all.identical - all.different.size()));
    if (!same_arithmetic)
        step.details.push_back(
            plain_text(fmt::format("note: the mathematical library or the processor that computed "
                                   "({}) is another than here ({})",
                                   report.arithmetic, arithmetic_fingerprint())));
    for (const std::string& maker : all.makers)
        step.details.push_back(plain_text(
            fmt::format("note: the folder's files were made by {}, recomputed by runcert {}, "
                        "source {}",
                        maker, program_version(), source_revision())));
    return step;
}

VerificationStep verify_report_text(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{.what = "contents"};
    const TemporaryFolder folder;
    if (const auto failed = recompute_report(run_dir, folder.path())) {
        step.finding = "report.json cannot be made from the folder's files";
        step.fail(plain_text(*failed));
        return step;
    }
    const FileComparison compared = compare_file(run_dir, folder.path(), report_file,
                                                 report.arithmetic == arithmetic_fingerprint());
    step.answer = compared.first ? LayerAnswer::not_verified : LayerAnswer::verified;
    step.finding = compared.identical ? "report.json is what its files make, byte for byte"
                   : compared.first   ? "report.json is not what its files make"
                                      : "report.json says what its files make";
    if (compared.first) step.details.push_back(plain_text(compared.sentence()));
    if (compared.first && !is_made_here(report))
        step.details.push_back(plain_text(fmt::format(
            "note: {}: verify with that program, or certify again", made_by_another(report))));
    return step;
}

}  // namespace runcert
