#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "stages/check/requirements.h"

namespace runcert {

/// Sentences, said one after another: `say("{} epochs were left out.", count)`.
struct Sentences {
    std::vector<std::string> said = {};

    template <class... Args>
    void operator()(fmt::format_string<Args...> text, Args&&... args) {
        said.push_back(fmt::format(text, std::forward<Args>(args)...));
    }
};

/// What must be read with a profile's verdict, a sentence each: definitions of speed that disagree,
/// a mean of several windows, the current, figures replaced, clauses that are not confirmed.
std::vector<std::string> notes_of(const ClauseContext& context);

/// Course, craft, wind and current in the window, as figures.
std::vector<Figure> course_figures(const ClauseContext& context);

/// The runs of the recording.
std::vector<RunSummary> run_summaries(const ClauseContext& context);

/// One sentence that compares the rules' speeds; empty for one rule.
std::string compared_rules(const std::vector<Profile>& profiles,
                           const std::vector<ProfileVerdict>& verdicts);

/// Statements to be read with every figure of the measurement, a sentence or two each: what the
/// uncertainty covers, how the noise was estimated and where that was impossible, how the filter
/// performed, what the recording does not say.
std::vector<std::string> statements_of(const CheckInput& input);

/// Whether the recorded velocities differ from the speed of the positions over the whole recording,
/// by more than 2 % and four standard uncertainties of their ratio.
bool is_another_speed(const VelocityComparison& velocity);

/// A sentence that says by how much.
std::string another_speed_text(const VelocityComparison& velocity);

}  // namespace runcert
