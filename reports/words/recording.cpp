#include "reports/words/recording.h"

#include <fmt/format.h>

#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"

namespace runcert {
std::vector<std::string> phase_sentences(const ScreenedPhaseTable& phases) {
    std::vector<std::string> sentences{fmt::format(
        "Carrier phases: {} in {} of epochs{}; noise {} mm at the zenith.",
        phases.slips == 0 ? "no slip" : counted(phases.slips, "slip"),
        counted(phases.pairs, "pair"),
        phases.repaired > 0 ? fmt::format(", {} of them repaired", phases.repaired) : "",
        format_fixed(phases.noise.white_m * 1e3, 1))};
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
    if (const MotionComparison& motion = phases.motion; motion.outcome == PhaseMotion::agrees)
        sentences.push_back(fmt::format(
            "The motion by carrier phases is that of the positions: over {} s they differ by {} m "
            "(median of {}).",
            format_fixed(motion.length_s, 0), format_fixed(*motion.median_difference_m, 3),
            counted(motion.windows, "window")));
    sentences.insert(sentences.end(), phases.notes.begin(), phases.notes.end());
    return sentences;
}

std::string phase_window_sentence(const WitnessedSpeed& phases) {
    const ShownFigures shown =
        shown_in({.speed_m_s = phases.speed_m_s,
                  .expanded_uncertainty_m_s = 2.0 * phases.standard_uncertainty_m_s},
                 speed_unit("km/h"));
    return fmt::format(
        "Over the window the phases of {} were unbroken (inside it {} and {} of epochs). They give "
        "{}, and the positions {} {}. The two displacements differ by {} m{}.",
        counted(phases.satellites.value_or(0), "satellite"),
        counted(phases.slips.value_or(0), "slip"),
        counted(phases.refusals.value_or(0), "refused pair"), measured_speed_text(shown),
        in_decimals_of(shown, phases.speed_m_s + phases.difference_m_s, SafeSide::down), shown.unit,
        format_fixed(phases.apart_m, 3),
        phases.apart_azimuth_deg ? fmt::format(", towards {} degrees from north",
                                               format_fixed(*phases.apart_azimuth_deg, 0))
                                 : "");
}

}  // namespace runcert
