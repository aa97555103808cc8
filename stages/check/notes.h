#pragma once

#include <string>
#include <vector>

#include "stages/check/requirements.h"

namespace runcert {

/// What must be read with a profile's verdict, a sentence each: definitions of speed on both sides
/// of the required speed, a mean of several windows, the current, figures replaced, clauses that
/// could not be confirmed.
std::vector<std::string> notes_of(const ClauseContext& context);

/// Course, craft, wind and current in the window, as figures.
std::vector<Figure> course_figures(const ClauseContext& context);

/// The runs of the recording.
std::vector<RunSummary> run_summaries(const ClauseContext& context);

/// One sentence that compares the rules' speeds; empty for one rule.
std::string compared_rules(const std::vector<Profile>& profiles,
                           const std::vector<ProfileVerdict>& verdicts);

}  // namespace runcert
