// What verification reads of a run folder, on a run made by this very program and changed by a
// script of edits: so that corpora do not age with the schemas. RUNCERT_FUZZ_FILES names the files
// that are edited; RUNCERT_FUZZ_RENDER: what the page is made from is read too.

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "fuzz_target.h"
#include "reports/certificate/report_html.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "trust/bundle.h"
#include "trust/run_standing.h"
#include "trust/verification.h"

namespace runcert::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr auto edited_files = std::to_array<std::string_view>({RUNCERT_FUZZ_FILES});

/// A signed run, and its files as they were made.
struct MadeRun {
    TemporaryFolder folder;
    Roster roster;
    std::array<std::string, edited_files.size()> made;

    fs::path run() const { return folder.path() / "run"; }

    MadeRun() {
        const std::string key = (folder.path() / "measurer").string();
        must({RUNCERT_PROGRAMS "/runcert", "keygen", "--out", key, "--no-password"});
        must({RUNCERT_PROGRAMS "/runcert", "certify",
              RUNCERT_SOURCE_DIR "/examples/land_yacht/attempt.yaml", "--out", run().string(),
              "--key", key + ".key", "--no-pdf"});
        const std::string file = key + ".pub";
        roster = roster_of_public_key(read_file(file), "measurer", file);
        for (std::size_t i = 0; i < edited_files.size(); ++i)
            made[i] = read_file(run() / edited_files[i]);
    }

  private:
    static void must(const std::vector<std::string>& command) {
        const ProcessResult result = run_process(command);
        require(result.exit_status < 2, "a run to begin with can be made");
    }
};

const MadeRun& made_run() {
    static const MadeRun run;
    return run;
}

/// The next bytes of the script as a number; 0 after its end.
std::size_t take_number(std::string_view& script, std::size_t bytes) {
    std::size_t number = 0;
    for (; bytes > 0 && !script.empty(); --bytes, script.remove_prefix(1))
        number = number * 256 + static_cast<unsigned char>(script.front());
    return number;
}

/// One edit: which file, what, where, how long, with which bytes.
void edit(std::array<std::string, edited_files.size()>& files, std::string_view& script) {
    std::string& text = files[take_number(script, 1) % files.size()];
    const std::size_t kind = take_number(script, 1) % 6;
    const std::size_t at = text.empty() ? 0 : take_number(script, 3) % text.size();
    const std::size_t length = take_number(script, 1);
    const std::string piece(script.substr(0, length % 64));
    if (kind != 2 && kind != 3) script.remove_prefix(piece.size());
    // Where what is changed begins, so that values are met: the next thing behind a blank.
    const std::size_t value = std::min(text.find_first_of(" :,\n", at), text.size());
    const std::size_t end = std::min(text.find_first_of(" ,\n", value + 1), text.size());
    if (kind == 0) text.replace(at, piece.size(), piece);
    if (kind == 1) text.insert(at, piece);
    if (kind == 2) text.erase(at, length);
    if (kind == 3) text.resize(at);
    if (kind == 4 && value < end) text.replace(value + 1, end - value - 1, piece);
    if (kind == 5) text.insert(at, text.substr(at, length * 8));
}

void write_over(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary).write(text.data(), std::ssize(text));
}

/// Whether a step of verification says so, or refuses.
template <class Look>
bool passes(const Look& look) {
    try {
        return look().is(LayerAnswer::verified);
    } catch (const Failure&) {
        return false;
    }
}

/// Whether a file was changed that the signature vouches for. What a page shows is looked at
/// elsewhere, and of a signature's file one line is nobody's.
bool is_vouched_for(std::string_view file) {
    return file != "report.html" && !file.ends_with(".minisig");
}

void verify_all(const MadeRun& base, bool unchanged, bool vouched_for_changed) {
    const fs::path run = base.run();
    const ReportFacts report = read_report_facts(run);
    const bool files = passes([&] { return verify_files(run, report); });
    (void)passes([&] { return verify_chain(run, report); });
    (void)passes([&] { return verify_rules(run); });
    (void)passes([&] { return verify_schemas(run, report); });
    (void)passes([&] { return verify_report(run, report); });
    SignatureRules rules{.roster = base.roster, .by_public_keys = true};
    rules.present = rules.at = UtcSecond(std::chrono::seconds(4'000'000'000));
    // Read to where the pages are rendered again, which the tests of the chain do.
    (void)passes([&] { return verify_pages(run, report, rules, RunStanding{}); });
    const bool signers = passes([&] { return verify_signatures(run, report, rules).signatures; });
    require(!unchanged || (files && signers), "the run as it was made is verified");
    require(!vouched_for_changed || !files || !signers, "a changed run is seen");
}

#ifdef RUNCERT_FUZZ_RENDER
void read_for_pages(const std::string& text) {
    const nlohmann::ordered_json report = parse_report(text, "report.json");
    (void)report_page(text, report, {});
    (void)report_print_page(text, report, {});
}
#else
void read_for_pages(const std::string&) {}
#endif

}  // namespace

void read_input(std::string_view bytes) {
    const MadeRun& base = made_run();
    auto files = base.made;
    for (std::size_t edits = 0; !bytes.empty() && edits < 16; ++edits)
        edit(files, bytes);
    bool vouched_for_changed = false;
    for (std::size_t i = 0; i < files.size(); ++i) {
        write_over(base.run() / edited_files[i], files[i]);
        vouched_for_changed |= files[i] != base.made[i] && is_vouched_for(edited_files[i]);
    }
    try {
        verify_all(base, files == base.made, vouched_for_changed);
    } catch (const Failure&) {
        require(files != base.made, "the run as it was made is read");
    }
    read_for_pages(files[0]);
}

}  // namespace runcert::fuzz
