#pragma once

#include <algorithm>
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

/// How much is told: the first page, the annex of a report, what an auditor needs, or that with all
/// lists in full. Each holds what the one before does.
enum class Level { page, annex, record, all };

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
    /// "0.018 km/h".
    std::string uncertainty_text(double uncertainty_m_s) const;
};

/// What is alike together, in the order of the first of each.
template <class T, class Alike>
std::vector<std::vector<T>> grouped(const std::vector<T>& all, Alike alike) {
    std::vector<std::vector<T>> groups;
    for (const T& one : all) {
        const auto same = std::ranges::find_if(
            groups, [&](const std::vector<T>& group) { return alike(group.front(), one); });
        (same == groups.end() ? groups.emplace_back() : *same).push_back(one);
    }
    return groups;
}

// Of a verdict.

/// Which speed counts, "Speed over 3 s, by the definition: displacement over time."
std::string rule_words(const Profile& profile);
/// A requirement in a row that a terminal can show, its name and state; beneath it what it asks,
/// and the evidence. Of the record also by what it was decided, its figures and its source.
Block requirement_rows(const ProfileVerdict& verdict, Level level);
/// What is certain of it before anything is read: its title, and by which rule.
Block outcome_facts(const ProfileVerdict& verdict, const std::string& vouched_by = {});
/// What the figures rest on, by who says it.
Block origin_facts(const std::vector<VerdictInput>& origins);
/// By how much the record must be beaten: "1 mph above the record"; how the body rounds the
/// required speed.
std::string margin_words(const Profile& profile);
std::string rounding_words(const Profile& profile);
/// "3.000 s from 2026-03-26T03:20:57.000Z".
std::string window_line(const WindowSpan& span);
/// "2026-03-26 13:50:57.000 (UTC+10:30)"; empty where the attempt names no offset.
std::string local_time(GpsTime time, const Attempt& attempt);
/// With which probability so many standard uncertainties hold a normal variable ([GUM] G.1.3).
double coverage_probability(double nominal_factor);
/// "k = 2, 95 %": the coverage factor, which few degrees of freedom make larger than the rule's,
/// and the probability that goes with the rule's.
std::string coverage_words(const RuleView& rule);
/// The speeds of a rule, and how it was decided, of these levels.
Block decision_facts(const RuleView& rule, Level from, Level to);
/// "margin.value is 2 mph in place of the rule's 1 mph. Reason: agreed": the figures whose names
/// are among these.
std::vector<std::string> override_words(const ProfileVerdict& verdict,
                                        const std::vector<std::string>& names);
/// What holds for all rules, and is said of them together.
struct SaidOfAll {
    std::vector<Fact> facts = {};
    std::vector<std::string> notes = {};
};
/// Empty where there is but one.
SaidOfAll said_of_all(const std::vector<RuleView>& rules, Level from, Level to);
/// Reason, decision of these levels, replaced figures, and notes, but for what is said of all
/// rules.
std::vector<Block> verdict_blocks(const RuleView& rule, Level from, Level to,
                                  const SaidOfAll& said = {});
/// The requirements of several rules in a table as wide as a page, each once, with what differs
/// between the rules beneath it.
Block requirements_table(const std::vector<RuleView>& rules);

// Of a window, and of the run that it is in.

/// When and where in the recording a window was.
Block span_facts(const WindowSpan& span);
/// The speeds that decide, in every unit.
Block result_table(const RuleView& rule);
/// The certified window, with its speed by each definition and method.
std::vector<Block> window_blocks(const RuleView& rule, const WindowSpan& span);
/// The certified windows, their speeds by each definition, by each rule's own arithmetic, of two
/// points of the craft, and of further windows.
std::vector<Block> windows_of_all(const std::vector<RuleView>& rules);
/// The fastest window of the raw positions, where it was refused; else none.
std::vector<Block> refused_blocks(const RuleView& rule);
/// The uncertainty of the certified window: what it rests on, its budget, what could be missed.
std::vector<Block> uncertainty_blocks(const RuleView& rule);
/// An error that the tests look for: "outlier of one epoch", "step of the positions".
std::string tested_error_text(Hypothesis hypothesis);
/// The blocks of the budget and of its check.
std::vector<Block> budget_blocks(const RuleView& rule);
/// The budgets beside each other, as contributions to each rule's speed.
std::vector<Block> budgets_of_all(const std::vector<RuleView>& rules);
/// What witnesses say of the speed; what the data say of course and craft; the runs of the craft,
/// where what several rules cut alike is one table.
std::vector<Block> witness_blocks(const std::vector<RuleView>& rules);
std::vector<Block> course_blocks(const std::vector<RuleView>& rules);
std::vector<Block> run_blocks(const std::vector<RuleView>& rules);

/// What the stages were told: of each parameter the figure used, its default, and who set it; those
/// that have the default only with all lists in full.
std::vector<Block> parameter_blocks(const Attempt& attempt,
                                    const std::vector<const Header*>& headers, Level level);

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
/// The time of the last row.
ElapsedTime last_time(const std::vector<ScreenedEpoch>& rows);

}  // namespace runcert
