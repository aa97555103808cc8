#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/claimed_text.h"
#include "core/text.h"
#include "reports/certificate/certificate_document.h"
#include "schemas/verdict/outcome.h"

namespace runcert {

namespace {

void describe_tests(std::vector<std::string>& words, const ScreeningBasis& basis) {
    words.push_back(
        "Every epoch is screened. Epochs are marked, never deleted. First each by itself: the kind "
        "of its solution, what the recording says of satellites, ambiguities and corrections, its "
        "stated standard deviation, the order of time. A gap in time ends a stretch.");
    words.push_back(fmt::format(
        "Then by detection, identification and adaptation (Baarda 1968; Teunissen 2018) in the "
        "state-space model of the motion, horizontally and, where heights were measured, "
        "vertically. The noise is estimated from what a first look leaves, with a variance factor "
        "for each fix type. Every epoch is tested for an outlier, for up to {} outliers in a row, "
        "and for a step and a drift of the positions. It is tested for a jump of the time stamps; "
        "every span of epochs for the model as a whole. Each test uses all measurements of the "
        "arc, before and after the supposed error. One pass of the Kalman filter forward and one "
        "of scores backward (de Jong & Penzer 1998) do this. They give what a least-squares "
        "adjustment with that error as an unknown would.",
        basis.burst_epochs_max));
    words.push_back(
        "The best supported error is adapted to: outliers are left out; a step, a drift or a jump "
        "of the time stamps ends the arc. The tests are repeated until they find nothing more. If "
        "the noise is as estimated, all of them together raise a false alarm at most at the "
        "family-wise rate.");
    words.push_back(
        "Witnesses beside the positions follow: the displacements by carrier phases, where raw "
        "signals were handed in; the recorded velocities, whose delay is estimated first; the "
        "accelerations, jerks and vertical rates that a craft of the class can make; and the other "
        "receiver, where there is one.");
}

void describe_estimated_noise(std::vector<std::string>& words) {
    words.push_back(
        "The noise is estimated from the recording unless the attempt requires the stated one. It "
        "is the most likely one given all usable epochs: the jerk density of the motion, the scale "
        "of the stated standard deviations, and the size and correlation time of a time-correlated "
        "position error. Where the recording does not determine them, the stated noise is used. "
        "Its variances are multiplied by the a posteriori variance of unit weight where that "
        "exceeds one.");
    words.push_back(
        "Within each arc position, velocity and acceleration are estimated from all usable epochs "
        "at once, in two ways that must agree: batch least squares, and a Kalman filter with "
        "Rauch-Tung-Striebel smoothing. A batch with a robust loss, over the epochs that the tests "
        "rejected too, is the check on screening.");
    words.push_back(
        "Every window of the rule's length that lies within one arc and holds usable epochs only "
        "is compared; the fastest gives the measured speed. Its speed is estimated with a bound on "
        "time-correlated position errors in place of the fitted ones. Its standard uncertainty is "
        "that of the budget, one row for each source, by the law of propagation of uncertainty; a "
        "Monte Carlo propagation of the same distributions checks it.");
    words.push_back(
        "The undetected error is bounded by the external reliability of the speed (Baarda 1968). "
        "For each kind of error, at every epoch and in every direction, it is the size that its "
        "test finds with the stated power only. What that size does to the speed is the undetected "
        "effect. The largest that is not a drift is a row of the budget. Where a witness agrees, "
        "that row is what screening and the witness together would have missed, drifts included.");
}

std::vector<std::string> description(const ReportInputs& inputs) {
    std::vector<std::string> words;
    if (inputs.receivers.front().screened.facts.georeferenced)
        words.push_back(
            "Positions are taken from the recording as they are. They are expressed as east, north "
            "and up at the origin given above, on the WGS 84 ellipsoid; their covariances are "
            "rotated with them.");
    else
        words.push_back("Engineering coordinates are taken from the recording as they are.");
    describe_tests(words, inputs.receivers.front().screened.basis);
    describe_estimated_noise(words);
    words.push_back(
        "The speeds of [DHD22] are computed beside it for comparison and decide nothing: Deakin, "
        "Holden & Daddo 2022, Precision of Derived Velocity from Kinematic GPS for Land Yachting "
        "Speed Record Attempt.");
    return words;
}

Block software_table(const ReportInputs& inputs) {
    Block block = table({"Program|34", "Version|22", "Source revision, or SHA-256 of its file|44"});
    const auto add_one = [&](const std::vector<std::string>& cells) {
        if (std::ranges::find(block.rows, cells, &TableRow::cells) == block.rows.end())
            add_row(block, cells);
    };
    for (const ReceiverResults& results : inputs.receivers)
        for (const Header* header : headers_of(results, inputs.verdict)) {
            add_one({header->stage, header->program_version, header->source_revision});
            for (const CalledProgram& program : header->programs)
                add_one({program.name + (program.isolation.empty() ? "" : " (without a sandbox)"),
                         program.version, program.sha256});
        }
    return block;
}

Block files_table(const std::vector<InputFile>& subjects) {
    Block block = table({"File|44", "What it is|40", ">Length|16"});
    for (const InputFile& subject : subjects) {
        const bool renamed = !subject.original.empty() && subject.original != subject.file;
        TableRow& row = add_row(
            block,
            {subject.file,
             subject.role + (renamed ? fmt::format(" (handed in as {})", subject.original) : ""),
             counted(static_cast<std::int64_t>(subject.bytes), "byte")});
        row.further.push_back(subject.sha256);
    }
    return block;
}

/// What an official answers for by hand.
void add_sheet(Section& section, const ReportInputs& inputs, const std::string& report_id) {
    add(section, heading("Attestation and signatures"));
    Block sheet = table({"Report, attested|24", "Requirement|52", "Signed for by|24"}, {}, "sheet");
    // What several rules ask alike is signed for once.
    std::vector<std::pair<const Requirement*, std::vector<std::string>>> asked;
    for (const ProfileVerdict& verdict : inputs.verdict.profiles)
        for (const Requirement& requirement : verdict.requirements) {
            if (requirement.status != RequirementStatus::attest) continue;
            auto same = std::ranges::find_if(asked, [&](const auto& one) {
                return one.first->clause == requirement.clause &&
                       one.first->text == requirement.text &&
                       answerer_text(*one.first) == answerer_text(requirement);
            });
            if (same == asked.end()) same = asked.insert(asked.end(), {&requirement, {}});
            same->second.push_back(verdict.profile);
        }
    for (const auto& [requirement, rules] : asked)
        add_row(sheet,
                {report_id + "  ☐ yes  ☐ no",
                 fmt::format("{}, {}: {}",
                             rules.size() > 1 && rules.size() == inputs.verdict.profiles.size()
                                 ? std::string("all rules")
                                 : listed(rules),
                             requirement->clause, requirement->text),
                 answerer_text(*requirement)});
    if (!sheet.rows.empty()) {
        add(section, paragraph("The recording cannot decide what follows. Whoever signs for it "
                               "answers for it, with runcert attest, or by hand on this sheet."));
        add(section, std::move(sheet));
    }
    Block signs = table({"Role|22", "Name|26", "Place and date|26", "Signature|26"}, {}, "sheet");
    for (const Official& official : inputs.attempt.officials) {
        TableRow& row = add_row(signs, {official.role, claimed(official.name), "", ""});
        if (!official.key.empty()) row.further.push_back(official.key);
    }
    add_row(signs, {"For the body", "", "", ""});
    add(section, std::move(signs));
    add(section, paragraph("This report is on the recordings named above and on nothing else. It "
                           "may be passed on whole, not in part.",
                           "note"));
}

}  // namespace

std::string answerer_text(const Requirement& requirement) {
    const AnsweredBy by = requirement.answered_by.value_or(
        AnsweredBy{.role = Answerer{}.role, .count = Answerer{}.count});
    return by.count > 1 ? fmt::format("{} of {}", by.count, by.role) : by.role;
}

Section method_section(const ReportInputs& inputs) {
    Section section{.anchor = "method", .title = "Method"};
    for (std::string& words : description(inputs))
        add(section, paragraph(std::move(words)));
    if (std::vector<std::string> items = deviations(inputs); !items.empty())
        add(section, titled_list("Deviations from method and rules", std::move(items)));
    add(section,
        parameter_blocks(inputs.attempt, headers_of(inputs.receivers.front(), inputs.verdict),
                         Level::annex));
    return section;
}

Section files_section(const ReportInputs& inputs, const std::string& report_id) {
    Section section{.anchor = "files", .title = "Files"};
    add(section, paragraph("This report is on these files, each named by the SHA-256 of its bytes, "
                           "and on nothing else."));
    add(section, files_table(inputs.files));
    add(section, software_table(inputs));
    add(section, heading("To check this report"));
    add(section, paragraph("What counts is the file report.json: this page shows what stands in it "
                           "and adds nothing. In the run folder, with the signer's public key from "
                           "a source you trust:"));
    add(section, code("runcert verify RUN_FOLDER --roster ROSTER"));
    add(section, code("minisign -Vm report.json -p KEY.pub"));
    add(section, paragraph("The first checks every file, the chain from recording to report, the "
                           "signatures and the time stamps. With --recompute it recomputes every "
                           "file from the recording. The second checks a signature with another "
                           "program."));
    add_sheet(section, inputs, report_id);
    add(section, paragraph("End of report " + report_id, "note"));
    return section;
}

}  // namespace runcert
