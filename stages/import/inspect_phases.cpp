#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/statistics.h"
#include "core/text.h"
#include "stages/import/inspect.h"
#include "witness/phase_rows.h"
#include "witness/phase_witness.h"

namespace runcert {
namespace {

constexpr std::int64_t phase_window_ns = 3'000'000'000;
constexpr double phase_gap_factor = 1.5;
/// A receiver whose median window moves less stands still (m).
constexpr double still_m = 0.03;
constexpr std::size_t most_phase_notes = 6;

/// "7 of GPS (1C 2W), 5 of Galileo (1C 5Q)".
std::string satellites_text(const PhaseRecord& record) {
    std::map<SatelliteSystem, std::set<std::uint8_t>> numbers;
    std::map<SatelliteSystem, std::set<SignalCode>> signals;
    for (const PhaseSatellite& satellite : record.satellites)
        for (const PhaseSignal& signal : record.of(satellite)) {
            if (!(signal.phase_cycles == signal.phase_cycles)) continue;
            numbers[satellite.id.system].insert(satellite.id.number);
            signals[satellite.id.system].insert(signal.code);
        }
    std::string text;
    for (const auto& [system, all] : numbers) {
        std::string codes;
        for (const SignalCode code : signals[system])
            codes += fmt::format("{}{}", codes.empty() ? "" : " ", to_text(code));
        text += fmt::format("{}{} of {} ({})", text.empty() ? "" : ", ", all.size(),
                            name_of(system), codes);
    }
    return text.empty() ? "none with a phase" : text;
}

/// Satellites above the mask whose phases are used, at an epoch.
std::string in_use_text(const PhaseRecord& record, const PhaseScreening& screening) {
    std::vector<double> counts;
    for (const PhaseEpoch& epoch : record.epochs) {
        int count = 0;
        for (const PhaseSatellite& satellite : record.of(epoch))
            for (std::size_t i = 0; i < satellite.signals; ++i) {
                const PhaseFinding& finding = screening.findings[satellite.first_signal + i];
                count += finding.use == PhaseUse::used && !finding.supports;
            }
        counts.push_back(count);
    }
    return fmt::format("{} at a time (median), {} to {}", format_fixed(median(counts), 0),
                       format_fixed(*std::ranges::min_element(counts), 0),
                       format_fixed(*std::ranges::max_element(counts), 0));
}

std::string epochs_text(const PhaseTable& head, const PhaseRecord& record) {
    std::string text = counted(head.epochs, "epoch");
    if (head.nominal_interval_s > 0.0)
        text += fmt::format(", mostly {} s apart", format_fixed(head.nominal_interval_s, 3));
    std::size_t gaps = 0;
    double longest_s = 0.0;
    for (std::size_t i = 1; i < record.epochs.size(); ++i) {
        const double step_s =
            static_cast<double>(record.epochs[i].time_ns - record.epochs[i - 1].time_ns) * 1e-9;
        if (step_s <= phase_gap_factor * head.nominal_interval_s) continue;
        ++gaps;
        longest_s = std::max(longest_s, step_s);
    }
    return text + (gaps == 0 ? std::string("; no gaps")
                             : fmt::format("; {}, the longest {} s",
                                           counted(static_cast<std::int64_t>(gaps), "gap"),
                                           format_fixed(longest_s, 1)));
}

std::string slips_text(const PhaseScreening& screening) {
    std::string text =
        screening.slips.empty()
            ? std::string("none")
            : fmt::format("{}", counted(static_cast<std::int64_t>(screening.slips.size())));
    text += fmt::format(" in {} of epochs", counted(screening.pairs, "pair"));
    if (!screening.refusals.empty())
        text += fmt::format("; {} could not be judged", screening.refusals.size());
    if (!screening.disturbed.empty())
        text += fmt::format("; {} disturbed by less than half a cycle", screening.disturbed.size());
    if (!screening.jumps.empty())
        text += fmt::format("; the clock jumped by milliseconds {} times", screening.jumps.size());
    return text;
}

struct Fastest {
    double speed_m_s = -1.0;
    double deviation_m_s = 0.0;
    std::size_t first = 0, satellites = 0;
};

struct PhaseMotion {
    std::vector<double> displacements_m;
    Fastest fastest;
};

PhaseMotion motion_of(const PhaseRecord& record, const PhaseScreening& screening) {
    PhaseMotion motion;
    for (std::size_t a = 0; a < record.epochs.size(); ++a) {
        const auto b = epoch_after(record, a, phase_window_ns);
        if (!b) continue;
        const auto displacement = displacement_between(record, screening, a, *b);
        if (!displacement) continue;
        const Eigen::Vector2d way_m = displacement->enu_m.head<2>();
        motion.displacements_m.push_back(way_m.norm());
        const double speed_m_s = way_m.norm() / displacement->interval_s;
        if (speed_m_s <= motion.fastest.speed_m_s) continue;
        const Eigen::Vector2d along =
            way_m.norm() > 0.0 ? Eigen::Vector2d(way_m.normalized()) : Eigen::Vector2d(1.0, 0.0);
        const double variance_m2 =
            along.dot(displacement->covariance_m2.topLeftCorner<2, 2>() * along);
        motion.fastest = {.speed_m_s = speed_m_s,
                          .deviation_m_s = std::sqrt(variance_m2) / displacement->interval_s,
                          .first = a,
                          .satellites = displacement->satellites};
    }
    return motion;
}

void add_motion(FactGroup& facts, const PhaseTable& head, const PhaseRecord& record,
                const PhaseScreening& screening) {
    const PhaseMotion motion = motion_of(record, screening);
    if (motion.displacements_m.empty()) {
        add_fact(facts, "Motion", "not enough unbroken phases of six satellites over 3 s to say");
        return;
    }
    const double typical_m = median(motion.displacements_m);
    add_fact(facts, "Motion",
             fmt::format("{}; {} of 3 s, the median one {} m",
                         typical_m < still_m ? "stands still" : "moves",
                         counted(std::ssize(motion.displacements_m), "window"),
                         format_fixed(typical_m, 3)));
    const Fastest& best = motion.fastest;
    const GpsTime start = head.first_epoch.plus_nanoseconds(record.epochs[best.first].time_ns);
    add_fact(facts, "Fastest 3 s",
             fmt::format("{} km/h ± {} km/h by carrier phase, {} satellites, from {} GPS time",
                         format_fixed(best.speed_m_s * km_h_per_m_s, 2),
                         format_fixed(2.0 * best.deviation_m_s * km_h_per_m_s, 2), best.satellites,
                         to_iso(start)));
}

}  // namespace

void add_phases(const StreamedPhases& phases, const std::string& navigation,
                const Observations& said, Recognition& is) {
    PhaseRecordBuilder builder(phases.head);
    phases.give([&](const PhaseRow& row) { builder.add(row); });
    PhaseRecord record = std::move(builder).take();
    locate_by_pseudoranges(record);
    const PhaseScreening screening = screen_phases(record, {});
    const PhaseTable& head = phases.head;
    FactGroup all{.title = "Raw measurements"};
    add_fact(all, "Format", head.format);
    add_fact(all, "Made by", head.device);
    for (const std::string& line : said.written_by)
        add_fact(all, "It says", line);
    add_fact(all, "Time", fmt::format("from {} GPS time", to_iso(head.first_epoch)));
    if (record.epochs.empty()) {
        add_fact(all, "Signals", "none of GPS or Galileo");
    } else {
        add_fact(all, "Epochs", epochs_text(head, record));
        add_fact(all, "Satellites", satellites_text(record));
        add_fact(all, "In use", in_use_text(record, screening));
        add_fact(all, "Slips", slips_text(screening));
        add_fact(all, "Noise",
                 fmt::format("{} mm of a phase's change at the zenith",
                             format_fixed(screening.noise.white_m * 1e3, 1)));
        add_motion(all, head, record, screening);
    }
    add_fact(all, "Orbits", navigation);
    is.said.push_back(std::move(all));
    if (said.simulated) is.concerns.push_back(simulated_concern());
    const auto note = [&](std::string says) {
        is.concerns.push_back({.code = ConcernCode::reading, .says = std::move(says)});
    };
    const std::size_t shown = std::min(head.notes.size(), most_phase_notes);
    for (std::size_t i = 0; i < shown; ++i)
        note(head.notes[i]);
    if (head.notes.size() > shown) note(fmt::format("and {} more", head.notes.size() - shown));
}

}  // namespace runcert
