#include "reports/words/screening.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "core/text.h"
#include "reports/words/figures.h"

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

std::string delay_words(double delay_s) {
    return fmt::format("{:.3g} s {}", std::abs(delay_s), delay_s < 0.0 ? "ahead of" : "behind");
}

std::string other_moments_text(const VelocityComparison& velocity) {
    constexpr std::size_t named = 3;
    std::vector<std::string> stretches;
    std::size_t beyond = 0;
    for (const VelocityDelay& one : velocity.delays) {
        if (!one.beyond || ++beyond > named) continue;
        stretches.push_back(fmt::format(
            "over epochs {} to {} they are {} the positions (the speeds differ by {} m/s, at that "
            "delay by {} m/s)",
            one.first_epoch, one.last_epoch, delay_words(one.delay_s),
            format_fixed(one.difference_within_m_s, 2), format_fixed(one.difference_m_s, 2)));
    }
    if (beyond > named) stretches.push_back(fmt::format("so over {} more", beyond - named));
    return fmt::format("{}", fmt::join(stretches, ", "));
}

std::string unfit_text(const VelocityComparison& velocity) {
    if (!velocity.unfit) return {};
    return fmt::format("they contradict the positions at {:.3g} % of the epochs",
                       100.0 * velocity.contradicted_share);
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
        "{} of {} recorded in motion repeat the one before, {} lie in line with their neighbours "
        "to the last digit; chance makes {}",
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

std::string displacement_comparison_text(const DisplacementComparison& comparison) {
    const std::string name =
        comparison.receiver.empty()
            ? capitalised(words_of(comparison.kind))
            : fmt::format("Displacements by receiver “{}”", comparison.receiver);
    if (comparison.spreads.empty())
        return name + ": too few spans have both to compare the displacements";
    const VelocitySpread& spread = comparison.spreads.front();
    return fmt::format("{}: over {:g} s they differ by {} m per axis ({}) and contradict {}", name,
                       spread.span_s, format_fixed(spread.sd_m, 3), counted(spread.spans, "span"),
                       counted(comparison.rejected, "epoch"));
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

std::string tested_error_text(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::outlier:
            return "outlier of one epoch";
        case Hypothesis::burst:
            return "outlier of several epochs";
        case Hypothesis::step:
            return "step of the positions";
        case Hypothesis::ramp:
            return "drift of the positions";
        default:
            return std::string(words_of(hypothesis));
    }
}

std::string where_text(const UndetectedError& error) {
    if (error.epoch != error.last_epoch)
        return fmt::format("at epochs {} to {}", error.epoch, error.last_epoch);
    switch (error.hypothesis) {
        case Hypothesis::outlier:
        case Hypothesis::burst:
            return fmt::format("at epoch {}", error.epoch);
        case Hypothesis::ramp:
            return fmt::format("from epoch {} on", error.epoch);
        default:
            return fmt::format("before epoch {}", error.epoch);
    }
}

std::string size_text(const UndetectedError& error) {
    return fmt::format("{} {}", significant_text(error.size, 2),
                       error.unit == "m / s" ? "m/s" : error.unit);
}

bool is_harmless(const UndetectedError& error) {
    return !(error.speed_m_s > 0.0);
}

bool is_unlimited(const UndetectedError& error) {
    constexpr double without_limit = 1e6;  // stands in the file for one without limit
    return error.size >= without_limit || error.speed_m_s >= without_limit;
}

std::string undetected_error_text(const UndetectedError& error, double power,
                                  const SpeedUnit& unit) {
    const std::string kind = tested_error_text(error.hypothesis);
    if (is_harmless(error))
        return fmt::format("no undetected {} could have changed the speed", kind);
    if (is_unlimited(error))
        return fmt::format(
            "an undetected {} ({}) could have any size: what it could have done to the speed has "
            "no limit",
            kind, where_text(error));
    return fmt::format(
        "an undetected {} of {} ({}) could have changed the speed by at most {} {}; a larger one "
        "is found with a probability of more than {:g}",
        kind, size_text(error), where_text(error),
        significant_text(error.speed_m_s * unit.per_m_s, 3), unit.name, power);
}

}  // namespace runcert
