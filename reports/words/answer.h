#pragma once

#include <string>
#include <vector>

#include "schemas/verdict/declared.h"

// The answer of a run, as a terminal shows it last.

namespace runcert {

/// A line of an answer: what it is of ("RESULT", "witness"), and what it says.
struct AnswerLine {
    std::string label;
    std::string says;
    bool is_row = false;  ///< of a table, whose columns stay as they are
};

/// One rule's answer in a sentence or two: "58.70 ± 0.19 km/h, required 55.67: exceeds the record.
/// Not yet beaten: 9 answers are due." Of what cannot be certified the reason.
std::string result_text(const ProfileVerdict& verdict);

/// Why a speed cannot be certified, in the first sentences of the reason, without a clause's id.
std::string refusal_text(const ProfileVerdict& verdict);

/// What stands behind the answer. Of one rule: window, speeds, witnesses, what was refused, and the
/// first notes; of several a row for each, and reasons that they share once.
std::vector<AnswerLine> answer_details(const Verdict& verdict);

/// RESULT: of one rule its answer; of several how many end in which way.
AnswerLine answer_result(const Verdict& verdict);

/// NEXT: what to read, and the command that says what is due or why something is refused. `page`:
/// the file to read.
AnswerLine answer_next(const Verdict& verdict, const std::string& run_folder,
                       const std::string& page);

/// The lines as text, broken at that many columns.
std::string answer_text(const std::vector<AnswerLine>& lines, std::size_t columns);

/// The first of them that need no more than that many lines; of more, where the rest is
/// ("runcert explain RUN").
std::string answer_text(const std::vector<AnswerLine>& lines, std::size_t columns,
                        std::size_t most_lines, const std::string& run_folder);

}  // namespace runcert
