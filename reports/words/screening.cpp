#include "reports/words/screening.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "core/figures.h"
#include "core/text.h"
#include "schemas/screened/witness_text.h"

namespace runcert {
namespace {

std::string_view adverb(TestedAxes axes) {
    return axes == TestedAxes::horizontal ? "horizontally" : "vertically";
}

std::string delay_text(const VelocityComparison& velocity) {
    if (!velocity.delay_s) return "the motion does not determine their delay";
    const double delay_s = *velocity.delay_s;
    const auto& sigma_s = velocity.sigma_delay_s;
    const int decimals = sigma_s && *sigma_s > 0.0 ? uncertainty_decimals(*sigma_s) : 3;
    return fmt::format("{} s{} {} the positions, which is allowed for",
                       format_fixed(std::abs(delay_s), decimals),
                       sigma_s ? fmt::format(" ± {} s", format_fixed(*sigma_s, decimals)) : "",
                       delay_s < 0.0 ? "ahead of" : "behind");
}

}  // namespace

std::string false_alarm_text(const ScreeningBasis& basis) {
    const double rate = basis.family_false_alarm_rate;
    if (!(rate > 0.0)) return "not stated";
    return fmt::format(
        "of {} recordings without an outlier at most one would have anything marked, by all {} "
        "together",
        counted(static_cast<std::int64_t>(std::floor(1.0 / rate + 1e-9))),
        counted(basis.tests, "test"));
}

std::string fix_type_errors_text(const FixTypeErrors& errors) {
    if (errors.judgement == AccuracyJudgement::too_few_epochs)
        return fmt::format("{}: {} ({})", adverb(errors.axes), words_of(errors.judgement),
                           counted(errors.epochs, "epoch"));
    return fmt::format(
        "{}: errors from epoch to epoch {} times the stated standard deviation ({}; {})",
        adverb(errors.axes), significant_text(std::sqrt(errors.variance_factor), 2),
        counted(errors.epochs, "epoch"), words_of(errors.judgement));
}

std::string velocity_comparison_text(const VelocityComparison& velocity) {
    if (velocity.origin == VelocityOrigin::positions) return std::string(words_of(velocity.origin));
    std::string text =
        velocity.compared == 0
            ? "too few could be compared with the motion, or they never change"
            : fmt::format("{}; compared at {}, they differ by {} m/s and contradict {}",
                          delay_text(velocity), counted(velocity.compared, "epoch"),
                          format_fixed(velocity.scale_m_s, 3), counted(velocity.rejected));
    if (const std::string others = other_moments_text(velocity); !others.empty())
        text = (velocity.compared == 0 ? "" : text + "; ") + others;
    if (const std::string unfit = unfit_text(velocity); !unfit.empty())
        text += fmt::format("; {}, and are no source of a speed", unfit);
    return text;
}

std::string device_signs_text(const DeviceSigns& device) {
    if (device.moving == 0) return "none looked for: the craft hardly moved";
    if (device.held + device.interpolated == 0)
        return fmt::format("none in {} recorded in motion", counted(device.moving, "position"));
    return fmt::format(
        "{} of {} recorded in motion repeat the one before, {} lie on a line or curve through "
        "others to the last digit; chance makes {}",
        counted(device.held), counted(device.moving, "position"), counted(device.interpolated),
        significant_text(device.by_chance, 2));
}

std::string time_fault_text(const TimeFault& fault) {
    const std::string size = format_fixed(std::abs(fault.size_s), 3) + " s";
    switch (fault.kind) {
        case TimeFaultKind::gap:
            return size + " missing";
        case TimeFaultKind::backward:
            return "the clock goes back by " + size;
        case TimeFaultKind::duplicate:
            return "the time of the epoch before";
        case TimeFaultKind::session:
            return fmt::format("another session begins, {} {}", size,
                               fault.size_s < 0.0 ? "earlier" : "later");
        case TimeFaultKind::whole_second_shift:
            break;
    }
    return fmt::format("the clock jumps by {} while the positions go on", size);
}

std::string baseline_comparison_text(const BaselineComparison& baseline) {
    if (baseline.compared == 0) return "could not be compared: no epochs at the same time";
    return fmt::format(
        "“{}”: antennas {} m apart, standard deviation {} m over {}; contradicted at {}",
        baseline.receiver, format_fixed(baseline.length_m, 3), format_fixed(baseline.sd_m, 3),
        counted(baseline.compared, "epoch"), counted(baseline.rejected));
}

std::string surface_text(const SurfaceComparison& surface) {
    return fmt::format(
        "{} compared, {} beside it; median {}{} m{}, scatter {} m; {} contradicted; "
        "an error of {} m is found with a probability of 0.8",
        counted(surface.compared), counted(surface.outside), surface.offset_m > 0.0 ? "+" : "",
        format_fixed(surface.offset_m, 3), surface.offset_removed ? " (a datum's, taken off)" : "",
        format_fixed(surface.scatter_m, 3), counted(surface.rejected),
        format_fixed(surface.detectable_m, 2));
}

}  // namespace runcert
