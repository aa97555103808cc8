#include "study_verdict.h"

namespace runcert {

ReceiverFindings findings_of(const ScreenedTable& screened, TrajectoryTable&& trajectory,
                             Windows&& windows) {
    ReceiverFindings found;
    for (const ScreenedEpoch& row : screened.rows)
        found.add(row, windows);
    found.receiver = screened.facts.receiver;
    found.facts = screened.facts;
    found.accuracy_source = "recording";
    found.format = "simulated";
    found.time_origin = "the satellites' time";
    found.solution_source = SolutionSource::recording;
    found.records = {.total = std::ssize(screened.rows)};
    found.tests = screened.basis;
    found.estimation = trajectory.estimation;
    found.windows = std::move(windows);
    found.trajectory = std::move(trajectory.rows);
    return found;
}

ProfileVerdict verdict_at(Attempt attempt, std::optional<double> record_m_s,
                          const ReceiverFindings& findings, const Profile& rule) {
    attempt.record.reset();
    if (record_m_s)
        attempt.record = Record{.speed = *record_m_s, .unit = "m/s", .source = "the truth"};
    return check({.attempt = attempt, .profiles = {rule}, .judged = findings}).profiles.front();
}

std::string reason_words(const std::string& reason) {
    constexpr std::size_t words_shown = 14;
    std::string text;
    std::size_t words = 0;
    for (const char letter : reason.substr(0, reason.find('\n'))) {
        if (letter == ' ' && ++words == words_shown) break;
        const bool number = (letter >= '0' && letter <= '9') ||
                            ((letter == '.' || letter == ',') && text.ends_with('#'));
        if (!number)
            text += letter;
        else if (!text.ends_with('#'))
            text += '#';
    }
    return text;
}

}  // namespace runcert
