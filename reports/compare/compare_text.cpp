#include <fmt/format.h>

#include "core/speed_unit.h"
#include "core/text.h"
#include "reports/compare/compare.h"

namespace runcert {
namespace {

std::string in_km_h(std::optional<double> mps) {
    return mps ? format_fixed(*mps * km_h_per_m_s, 3) : "-";
}

std::string in_seconds(std::optional<ElapsedTime> time) {
    return time ? format_fixed(time->seconds(), 3) : "-";
}

std::string_view short_name(SpeedDefinition definition) {
    switch (definition) {
        case SpeedDefinition::displacement:
            return "d/T";
        case SpeedDefinition::path_length:
            return "path/T";
        case SpeedDefinition::mean_n_plus_1:
            return "N+1";
        case SpeedDefinition::mean_n:
            return "N";
        case SpeedDefinition::elapsed_time:
            return "L/T";
    }
    return "";
}

std::string heading(const ProfileComparison& profile) {
    std::string text =
        fmt::format("\n{}: {} s, {}; {} windows can be certified\n", profile.profile,
                    profile.duration_s, words_of(profile.definition), profile.candidates);
    if (!profile.certified_start) return text + "no certified window\n";
    text += fmt::format("certified window: {} s from {} s", in_seconds(profile.certified_duration),
                        in_seconds(profile.certified_start));
    if (profile.true_m_s)
        text += fmt::format("; true speed in it {} km/h", in_km_h(profile.true_m_s));
    return text + "\n";
}

std::string column_names(bool with_truth) {
    std::string text =
        fmt::format("{:<32} {:<6} {:>9} {:>9} {:>9}", "", "", "best", "best", "certified");
    if (with_truth) text += fmt::format(" {:>9} {:>9} {:>9}", "RMS", "error in", "error in");
    text += fmt::format("\n{:<32} {:<6} {:>9} {:>9} {:>9}", "method", "by", "from s", "window",
                        "window");
    if (with_truth) text += fmt::format(" {:>9} {:>9} {:>9}", "error", "certified", "best");
    return text + "\n";
}

std::string row(const MethodResult& method, bool with_truth) {
    std::string text = fmt::format("{:<32} {:<6} {:>9} {:>9} {:>9}", method.name,
                                   short_name(method.window_speed), in_seconds(method.best_start),
                                   in_km_h(method.best_m_s), in_km_h(method.certified_m_s));
    if (with_truth)
        text += fmt::format(" {:>9} {:>9} {:>9}", in_km_h(method.rms_error_m_s),
                            in_km_h(method.certified_error_m_s), in_km_h(method.best_error_m_s));
    return text + "\n";
}

std::string legend(const Comparison& comparison) {
    std::string text =
        "\nby: d/T displacement over time, path/T path length over time, N+1 mean of the window's\n"
        "speeds, both ends included; N the same without the first, each speed being that of the\n"
        "step before it. certified: the speed that the certificate states.\n";
    if (comparison.with_truth)
        text += fmt::format(
            "Errors are estimate less truth. The truth of a window is by the profile's "
            "definition;\n"
            "RMS is of the speeds at {} of {} epochs, those with truth.\n",
            comparison.epochs_with_truth, comparison.epochs);
    for (const std::string& note : comparison.notes)
        text += note + ".\n";
    return text;
}

}  // namespace

std::string comparison_text(const Comparison& comparison, const std::string& attempt) {
    std::string text = fmt::format(
        "All estimators side by side: attempt {}, receiver {}. Speeds in km/h, times in s.\n",
        attempt, comparison.receiver);
    for (const ProfileComparison& profile : comparison.profiles) {
        text += heading(profile) + column_names(comparison.with_truth);
        for (const MethodResult& method : profile.methods)
            text += row(method, comparison.with_truth);
    }
    return text + legend(comparison);
}

}  // namespace runcert
