#include "reports/words/recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"

namespace runcert {
namespace {

std::string millimetres(double value_m) {
    return format_fixed(value_m * 1e3, 1) + " mm";
}

std::string motion_sentence(const MotionComparison& motion) {
    if (motion.outcome != PhaseMotion::agrees) return {};
    return fmt::format(
        "The motion by carrier phases is that of the positions: over {} s they differ by {} m "
        "(median of {}).",
        format_fixed(motion.length_s, 0), format_fixed(*motion.median_difference_m, 3),
        counted(motion.windows, "window"));
}

}  // namespace

std::string noise_status_text(const NoiseSummary& noise) {
    if (noise.status == NoiseBasis::fitted)
        return fmt::format("estimated from {}", counted(noise.epochs, "epoch"));
    if (noise.status == NoiseBasis::too_few_epochs)
        return fmt::format("not estimated: {}, at least {} required; the stated noise is used",
                           counted(noise.epochs, "usable epoch"), counted(noise.epochs_needed));
    return fmt::format("not estimated: {}; the stated noise is used", words_of(noise.status));
}

std::string noise_parameter_text(const NoiseParameter& parameter, const NoiseSummary& noise,
                                 std::string_view unit) {
    constexpr double small = 0.3;
    constexpr double hardly_any = 5.0;  // a factor of 150 either way
    const auto with_unit = [&](std::string figure) {
        return unit.empty() ? figure : fmt::format("{} {}", figure, unit);
    };
    const auto& relative = parameter.relative_uncertainty;
    const std::string value = with_unit(significant_text(parameter.value, 3));
    if (noise.status != NoiseBasis::fitted) return value;
    const std::string limit = parameter.at_bound ? "; at the limit of its range" : "";
    if (!relative || !(*relative < hardly_any))
        return value + ", uncertainty not determined by the data" + limit;
    const double sigma = *relative * parameter.value;
    if (*relative < small && sigma > 0.0)
        return fmt::format("{} ± {}{}",
                           with_unit(format_fixed(parameter.value, uncertainty_decimals(sigma))),
                           with_unit(uncertainty_text(sigma)), limit);
    return fmt::format("{}, × or ÷ {}{}", value, significant_text(std::exp(*relative), 3), limit);
}

std::string engineering_crs_text() {
    return "engineering CRS, not tied to the Earth: its place, orientation and scale are not "
           "stated";
}

std::string place_text(const FramePlace& place) {
    return fmt::format("{} s on: latitude {}°, longitude {}°, ellipsoidal height {} m",
                       format_fixed(place.from.seconds(), 1),
                       format_fixed(place.position.latitude.degrees(), 9),
                       format_fixed(place.position.longitude.degrees(), 9),
                       format_fixed(place.position.height_m, 3));
}

std::vector<std::string> phase_sentences(const ScreenedPhaseTable& phases) {
    std::vector<std::string> sentences;
    std::string slips = fmt::format("Carrier phases: {} in {} of epochs",
                                    phases.slips == 0 ? "no slip" : counted(phases.slips, "slip"),
                                    counted(phases.pairs, "pair"));
    if (phases.repaired > 0) slips += fmt::format(", {} of them repaired", phases.repaired);
    slips += fmt::format("; noise {} at the zenith.", millimetres(phases.noise.white_m));
    sentences.push_back(std::move(slips));
    if (phases.refusals > 0)
        sentences.push_back(fmt::format("{} of epochs could not be judged, and end every arc.",
                                        counted(phases.refusals, "pair")));
    if (phases.disturbed > 0)
        sentences.push_back(
            fmt::format("In {} the phases were disturbed by less than half a cycle.",
                        counted(phases.disturbed, "pair")));
    if (!phases.clock_jumps.empty())
        sentences.push_back(fmt::format(
            "The receiver's clock jumped by whole milliseconds: {}; of a window across one the "
            "phases say nothing.",
            counted(std::ssize(phases.clock_jumps), "time")));
    if (std::string motion = motion_sentence(phases.motion); !motion.empty())
        sentences.push_back(std::move(motion));
    sentences.insert(sentences.end(), phases.notes.begin(), phases.notes.end());
    return sentences;
}

std::string phase_window_sentence(const WitnessedSpeed& phases) {
    const std::int64_t slips = phases.slips.value_or(0), refusals = phases.refusals.value_or(0);
    const ShownFigures shown =
        shown_in({.speed_m_s = phases.speed_m_s,
                  .expanded_uncertainty_m_s = 2.0 * phases.standard_uncertainty_m_s},
                 speed_unit("km/h"));
    return fmt::format(
        "Over the window the phases of {} were unbroken; {} found inside it, and {} refused. They "
        "give {}, and the positions {} {}. The two displacements differ by {} m{}.",
        counted(phases.satellites.value_or(0), "satellite"),
        slips == 0   ? "no slip was"
        : slips == 1 ? "1 slip was"
                     : fmt::format("{} slips were", slips),
        refusals == 0   ? "no pair of epochs was"
        : refusals == 1 ? "1 pair of epochs was"
                        : fmt::format("{} pairs of epochs were", refusals),
        measured_speed_text(shown),
        beside(shown, phases.speed_m_s + phases.difference_m_s, SafeSide::down), shown.unit,
        format_fixed(phases.apart_m, 3),
        phases.apart_azimuth_deg ? fmt::format(", towards {} degrees from north",
                                               format_fixed(*phases.apart_azimuth_deg, 0))
                                 : std::string());
}

std::string slip_evidence(const ScreenedPhase& row) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
    if (row.cycles)
        add(fmt::format("{} ± {} cycles", format_fixed(*row.cycles, 2),
                        format_fixed(row.sigma_cycles.value_or(0.0), 2)));
    if (row.begins == ArcStart::geometry_free)
        add(fmt::format("its bands parted by {} m, at most {} m",
                        format_fixed(row.statistic.value_or(0.0), 3),
                        format_fixed(row.threshold.value_or(0.0), 3)));
    else
        add(fmt::format("square sum of the weighted residuals {}, at most {}",
                        format_fixed(row.statistic.value_or(0.0), 1),
                        format_fixed(row.threshold.value_or(0.0), 1)));
    if (row.wide_lane_cycles)
        add(fmt::format("wide lane {} cycles", format_fixed(*row.wide_lane_cycles, 2)));
    if (row.beyond_doppler_cycles)
        add(fmt::format("beyond Doppler {} cycles", format_fixed(*row.beyond_doppler_cycles, 2)));
    if (row.begins != ArcStart::geometry_free && row.begins != ArcStart::displacement)
        add("repaired");
    return text;
}

}  // namespace runcert
