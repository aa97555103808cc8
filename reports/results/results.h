#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/attitude/declared.h"
#include "schemas/document/document.h"
#include "schemas/observations/observations.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/windows/windows.h"

// What the stages found, as blocks.

namespace runcert {

/// How much is told: what the annex of a report has, what an auditor needs, or that with all lists
/// in full.
enum class Level { annex, record, all };

/// What was found by one rule.
struct RuleView {
    const Attempt& attempt;
    const ProfileVerdict& verdict;
    const Profile& profile;
    const ProfileWindows* windows = nullptr;  ///< of a receiver; null if none were searched
    bool several = false;                     ///< whether there are others, so that titles name it

    /// The verdict's unit, else the rule's.
    const SpeedUnit& unit() const;
    /// The certified window; null if there is none.
    const CertifiableWindow* best() const;
    /// "Budget: rule “nalsa”", where there are several rules.
    std::string titled(const std::string& title) const;
    /// The figures as they are to be read; those of the window where the verdict has no speed, and
    /// the required speed alone where there is neither.
    ShownFigures shown() const;
};

/// Which speed counts, "Speed over 3 s, by the definition: displacement over time."
std::string rule_words(const Profile& profile);

/// One speed, to be shown in every unit.
struct SpeedRow {
    std::string label;
    std::optional<double> speed_m_s;
    SpeedKind kind = SpeedKind::measured;
    bool counts = false;  ///< the one that the rule counts
};
/// Rows of one speed each, in every unit, the rule's own first, with the decimals of the figures on
/// the first page. Rows without a speed are left out.
Block speed_table(const std::string& title, const std::vector<SpeedRow>& rows,
                  const RuleView& rule);

// Of a verdict.

/// The state in words, in capitals where it must be seen: "met", "NOT MET".
std::string state_text(RequirementStatus status);
/// A requirement in a row, its name and state; beneath it what it asks, and the evidence.
TableRow requirement_row(const Requirement& requirement);
/// What else is known of it: its figures, and its source.
std::vector<std::string> requirement_lines(const Requirement& requirement);
/// "margin.value is 2 mph in place of the rule's 1 mph. Reason: agreed": the figures whose names
/// are among these, or all.
std::vector<std::string> override_words(const ProfileVerdict& verdict,
                                        const std::vector<std::string>& names = {});
/// The requirements in a table as wide as a page.
Block requirements_table(const RuleView& rule);
/// Reason, decision, these requirements, replaced figures, and notes other than those said already.
std::vector<Block> verdict_blocks(const RuleView& rule, Block requirements,
                                  const std::vector<std::string>& said = {});

// Of a window, and of the run that it is in.

/// When and where in the recording a window was.
Block span_facts(const WindowSpan& span);
/// The speeds that decide, in every unit.
Block result_table(const RuleView& rule);
/// The certified window, with its speed by each definition and method.
std::vector<Block> window_blocks(const RuleView& rule, const WindowSpan& span);
/// The fastest window of the raw positions, where it was refused; else none.
std::vector<Block> refused_blocks(const RuleView& rule);
/// The uncertainty of the certified window: what it rests on, its budget, what could be missed.
std::vector<Block> uncertainty_blocks(const RuleView& rule);
/// An error that the tests look for: "outlier of one epoch", "step of the positions".
std::string tested_error_text(Hypothesis hypothesis);
/// The blocks of the budget and of its check.
std::vector<Block> budget_blocks(const RuleView& rule);
/// What witnesses say of the speed; what the data say of course and craft; the runs of the craft.
std::vector<Block> witness_blocks(const RuleView& rule);
std::vector<Block> course_blocks(const RuleView& rule);
/// Runs that several rules cut alike are one table.
std::vector<Block> run_blocks(const std::vector<RuleView>& rules);

// Of several rules together, what is alike once.

/// The requirements of all rules, each once, with what differs between the rules beneath it.
Block requirements_of_all(const std::vector<RuleView>& rules);
/// The notes that all verdicts have.
std::vector<std::string> said_of_all(const std::vector<RuleView>& rules);
/// The certified windows, their speeds by each definition, and by each rule's own arithmetic.
std::vector<Block> windows_of_all(const std::vector<RuleView>& rules);
/// The budgets beside each other, as contributions to each rule's speed.
std::vector<Block> budgets_of_all(const std::vector<RuleView>& rules);

// Of a receiver.

/// What its recording holds, of so many epochs up to a time, and what the attempt states of it.
Block recording_facts(const Observations& observations, const Receiver& receiver,
                      std::int64_t epochs, ElapsedTime last);
/// The frame of its positions; engineering coordinates have no origin.
Block frame_facts(const std::optional<FrameOrigin>& origin);
/// What screening decided and what its tests rested on. To an auditor every fault of the time
/// stamps, every decision with its rows in the recording, and the minimal detectable biases.
std::vector<Block> screening_blocks(const ScreenedTable& screened, Level level);
/// The decisions, in the order of the rows: every break, every row. Rows left out one after the
/// other by the same decision are one entry. Entries begin with "epoch ..." or "epochs ...", those
/// of breaks with "before epoch ...". With `all`, rows that are used are entries too.
std::vector<Block> decision_blocks(const ScreenedTable& screened, bool all);
/// The estimate, and the noise that it rests on.
std::vector<Block> estimation_blocks(const EstimationSummary& estimation);
/// Whether IMU and positions agree, with what the solution found of the IMU's clock, place and
/// axes.
std::vector<Block> attitude_facts(const AttitudeTable& attitude);

/// Counts hold every fault of the time stamps, the table a thousand of them at most.
std::int64_t time_stamp_faults(const TimeStampSummary& time);
/// Length of the longest arc; 0 where there is none.
double longest_arc_s(const std::vector<ScreenedEpoch>& rows);
/// The time of the last row.
ElapsedTime last_time(const std::vector<ScreenedEpoch>& rows);

}  // namespace runcert
