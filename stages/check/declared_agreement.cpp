#include "stages/check/declared_agreement.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/rounding.h"
#include "core/uncertainty.h"
#include "reports/words/figures.h"
#include "stages/check/course_speed.h"

namespace runcert {
namespace {

/// Sets the other speed from times at the lines, or why there is none.
void set_from_times(const JudgedSpeed& judged, const SecondaryMethod::LineTimes& times,
                    const std::optional<Course>& course, DeclaredAgreement& agreement) {
    constexpr double same_crossing_s = 2.0;
    if (!judged.over_course || !course) {
        agreement.missing = "times at the lines of a course say nothing of this rule's window";
        return;
    }
    if (!judged.span.start_gps) {
        agreement.missing = "its times cannot be compared: the recording's time is relative";
        return;
    }
    const GpsTime end = judged.span.start_gps->plus_nanoseconds(judged.span.duration.nanoseconds);
    const double start_s = times.start.seconds_since(*judged.span.start_gps);
    const double finish_s = times.finish.seconds_since(end);
    if (std::abs(start_s) > same_crossing_s || std::abs(finish_s) > same_crossing_s) {
        agreement.missing = fmt::format(
            "its times are {:+.3f} s and {:+.3f} s off those of the window: they are of another "
            "run, or of another clock",
            start_s, finish_s);
        return;
    }
    const double elapsed_s = times.finish.seconds_since(times.start);
    agreement.other_m_s = course_speed_m_s(course->length_m, elapsed_s, 0.0);
    agreement.other_expanded_uncertainty_m_s =
        std::hypot(std::numbers::sqrt2 * times.expanded_uncertainty_s * agreement.other_m_s,
                   course->length_expanded_uncertainty_m) /
        elapsed_s;
}

}  // namespace

std::string second_method_text(const DeclaredAgreement& second) {
    return fmt::format(
        "the second method ({}) gives {}, {:+.3f} km/h against this one (normalised error {:.2f}, "
        "at most 1)",
        second.method,
        speed_with_uncertainty_text(second.other_m_s, second.other_expanded_uncertainty_m_s,
                                    speed_unit("km/h")),
        (second.other_m_s - second.judged_m_s) * 3.6, second.normalised_error);
}

DeclaredAgreement compare_declared(const JudgedSpeed& judged, const SecondaryMethod& method,
                                   const std::optional<Course>& course) {
    DeclaredAgreement agreement;
    agreement.method = method.method;
    agreement.judged_m_s = judged.speed_m_s;
    if (method.times) {
        set_from_times(judged, *method.times, course, agreement);
        if (!agreement.missing.empty()) return agreement;
    } else {
        agreement.other_m_s = method.speed->speed_m_s;
        agreement.other_expanded_uncertainty_m_s = method.speed->expanded_uncertainty_m_s;
    }
    const double difference_m_s = std::abs(agreement.other_m_s - agreement.judged_m_s);
    const double allowed_m_s = std::hypot(usual_coverage_factor * judged.standard_uncertainty_m_s,
                                          agreement.other_expanded_uncertainty_m_s);
    agreement.normalised_error = difference_m_s == 0.0 ? 0.0 : difference_m_s / allowed_m_s;
    return agreement;
}

}  // namespace runcert
