#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"
#include "stages/import/nmea/epoch.h"

/// NMEA 0183 logs: GGA, RMC, VTG, GST, GSA and ZDA sentences of any talker, several of which make
/// an epoch.
namespace runcert::nmea {
namespace {

/// The date that a recording's epochs are counted from.
struct FirstDay {
    std::int64_t day = 0;  ///< of its first epoch, days since 1980-01-06
    /// Whether dates of epochs without a fix count: no other epoch has one. A receiver that has no
    /// fix writes what its own clock has kept.
    bool without_fix = false;
};

/// The date of a recording's first epoch, by counting back from the first that is dated: not within
/// a minute of midnight, where dates come early or late, unless all are, of which most decide.
/// Nothing where none is dated. Reads no further than it must.
std::optional<FirstDay> find_first_day(const RecordingBytes& recording) {
    const auto absent = [&](std::string_view what) {
        return recording.bytes.find(what) == std::string_view::npos;
    };
    if (absent("RMC,") && absent("ZDA,")) return std::nullopt;
    EpochReader epochs(recording, nullptr);
    DayCount count;
    std::optional<FirstDay> without_fix;
    std::map<std::int64_t, int> first_days;  // by the dated epochs at midnight, which may be wrong
    while (const auto epoch = epochs.next()) {
        const std::int64_t days = count.next(epoch->time_of_day_ns);
        if (!epoch->date) continue;
        const std::int64_t first = *epoch->date - days;
        if (!has_fix(*epoch)) {
            if (!without_fix) without_fix = FirstDay{.day = first, .without_fix = true};
            continue;
        }
        if (!is_near_midnight(epoch->time_of_day_ns)) return FirstDay{.day = first};
        ++first_days[first];
    }
    if (first_days.empty()) return without_fix;
    return FirstDay{.day = std::ranges::max_element(first_days, {}, [](const auto& day) {
                               return day.second;
                           })->first};
}

/// The day that an epoch says it is on, days since 1980-01-06; nothing where it says none that
/// counts.
std::optional<std::int64_t> day_of(const Epoch& epoch, const std::optional<FirstDay>& first) {
    if (!epoch.date || !first || !(first->without_fix || has_fix(epoch))) return std::nullopt;
    return *epoch.date;
}

/// Whether the velocities of VTG, which has no time, and RMC can be of the same moment.
bool agree(const WrittenNumber& a_m_s, const WrittenNumber& b_m_s) {
    return std::abs(*a_m_s.value - *b_m_s.value) <= a_m_s.step + b_m_s.step;
}

/// The correlation of east and north errors by an error ellipse, where it says the same of north
/// and east as the standard deviations do, to within how both are written.
OptionalReal correlation_of_ellipse(const ErrorStatistics& errors) {
    const double major_m = *errors.semi_major_m.value, minor_m = *errors.semi_minor_m.value;
    const double azimuth_rad = Angle::from_degrees(*errors.orientation_deg).radians();
    const double north = std::cos(azimuth_rad), east = std::sin(azimuth_rad);
    const double sigma_north_m = std::hypot(major_m * north, minor_m * east);
    const double sigma_east_m = std::hypot(major_m * east, minor_m * north);
    const auto same = [&](double sigma_m, const WrittenNumber& stated) {
        const double rounding_m = stated.step + errors.semi_major_m.step;
        return std::abs(sigma_m - *stated.value) <= rounding_m + 0.05 * *stated.value;
    };
    if (!same(sigma_north_m, errors.sigma_north_m) || !same(sigma_east_m, errors.sigma_east_m))
        return std::nullopt;
    return (major_m - minor_m) * (major_m + minor_m) * north * east /
           (sigma_north_m * sigma_east_m);
}

/// Counts of what the rows of a recording were made of.
struct RowTally {
    std::int64_t above_sea_level = 0;
    std::int64_t separation_of_another = 0;
    std::int64_t without_height = 0;
    std::int64_t in_plane = 0;
    std::int64_t velocities_disagree = 0;
    std::int64_t ellipses_disagree = 0;
};

/// Makes rows of epochs, and counts what the notes say of them.
class RowMaker {
  public:
    explicit RowMaker(const RecordingBytes& recording) : recording_(recording) {}

    /// The row of an epoch that says_position. A height without a geoid separation, or with one of
    /// zero where others have one, gets that of the epoch before it, or else of the first.
    TimedRow row(const Epoch& epoch, GpsTime instant) {
        const Solution& solution = solution_of(epoch);
        TimedRow row;
        row.instant = instant;
        row.written.time = epoch.time_text;
        const Solution& counts = epoch.gga.given ? epoch.gga : epoch.gns;
        row.observation.satellites = counts.satellites;
        row.observation.fix = FixType::none;
        if (!has_fix(epoch)) return row;
        row.observation.fix = solution.fix;
        row.observation.age_s = counts.age_s;
        if (epoch.satellite_lists_in_plane > 0) ++tally_.in_plane;
        set_solution(row, solution);
        set_ground_velocity(row.observation, epoch);
        set_errors(row.observation, epoch.errors);
        return row;
    }

    const RowTally& tally() const { return tally_; }

  private:
    std::optional<double> known_separation_m() {
        if (separation_m_ || std::exchange(looked_for_, true)) return separation_m_;
        EpochReader epochs(recording_, nullptr);
        while (const auto epoch = epochs.next())
            for (const Solution* solution : {&epoch->gga, &epoch->gns})
                if (solution->has_height && solution->separation_m.value_or(0.0) != 0.0)
                    return separation_m_ = *solution->separation_m;
        return std::nullopt;
    }

    void set_solution(TimedRow& row, const Solution& solution) {
        set_position(row.observation, *solution.position);
        if (solution.has_height && solution.separation_m.value_or(0.0) != 0.0) {
            separation_m_ = *solution.separation_m;
        } else if (const auto separation_m =
                       solution.has_height ? known_separation_m() : std::nullopt;
                   separation_m && (solution.above_sea_level || std::abs(*separation_m) > 1.0)) {
            row.observation.height_m = *row.observation.height_m + *separation_m;
            ++tally_.separation_of_another;
        } else if (solution.above_sea_level) {
            ++tally_.above_sea_level;
        }
        if (!solution.has_height) {
            row.observation.height_m.reset();
            ++tally_.without_height;
        }
        row.written.unit = CoordinateUnit::arc_minute;
        row.written.coordinates = {solution.coordinates[0], solution.coordinates[1], {}};
    }

    void set_ground_velocity(Observation& row, const Epoch& epoch) {
        const GroundVelocity &vtg = epoch.vtg_velocity, &rmc = epoch.rmc_velocity;
        const bool both = vtg.speed_m_s.value && rmc.speed_m_s.value;
        const bool disagree = both && !agree(vtg.speed_m_s, rmc.speed_m_s);
        if (disagree) ++tally_.velocities_disagree;
        const WrittenNumber& speed_m_s =
            disagree ? rmc.speed_m_s : finer(vtg.speed_m_s, rmc.speed_m_s);
        const WrittenNumber& course_deg =
            disagree ? rmc.course_deg : finer(vtg.course_deg, rmc.course_deg);
        if (speed_m_s.value) set_speed(row, *speed_m_s.value, course_of(course_deg.value));
    }

    void set_errors(Observation& row, const ErrorStatistics& errors) {
        row.sigma_north_m = errors.sigma_north_m.value;
        row.sigma_east_m = errors.sigma_east_m.value;
        if (row.height_m) row.sigma_up_m = errors.sigma_up_m;
        if (!row.sigma_north_m || !row.sigma_east_m || !errors.semi_major_m.value ||
            !errors.semi_minor_m.value || !errors.orientation_deg)
            return;
        row.correlation_east_north = correlation_of_ellipse(errors);
        if (!row.correlation_east_north) ++tally_.ellipses_disagree;
    }

    const RecordingBytes& recording_;
    std::optional<double> separation_m_;  ///< the last that is not zero, or the first to come
    bool looked_for_ = false;             ///< whether the first to come was
    RowTally tally_;
};

/// "NMEA 0183 with GGA, RMC, GST".
std::string variant_of(unsigned sentences) {
    std::vector<std::string_view> words;
    for (std::size_t i = 0; i < sentence_kinds.size(); ++i)
        if ((sentences >> i) & 1U) words.push_back(sentence_kinds[i].word);
    return fmt::format("NMEA 0183 with {}", fmt::join(words, ", "));
}

/// A note that counts something, where there was any: "Sentences ...: 3."
void note(Observations& observations, std::string_view what, std::int64_t count) {
    if (count > 0) observations.notes.push_back(fmt::format("{}: {}.", what, count));
}

void note_sentences(Observations& observations, const Tally& tally, const PassedOver& passed_over) {
    note(observations, "Sentences that have no checksum, and were taken as they are",
         tally.without_checksum);
    note(observations, "Lines that hold no NMEA sentence, and were passed over",
         passed_over.lines_without_sentence);
    note(observations, "Sentences whose time field is empty, which were left out",
         tally.without_time);
    note(observations,
         "Sentences that repeat one of the same type and time, and were left out, because the "
         "recording may be of two receivers merged",
         tally.repeated);
    note(observations,
         "GGA sentences with a quality of 7 or more (manual input, simulator or a maker's own), "
         "whose fix type is unknown",
         tally.odd_qualities);
}

void note_rows(Observations& observations, const RowTally& tally) {
    note(observations,
         "Heights written without a geoid separation, which are above mean sea level and not above "
         "the ellipsoid",
         tally.above_sea_level);
    note(observations,
         "Heights whose geoid separation is missing, or zero where others have one: that of the "
         "epochs beside them was added",
         tally.separation_of_another);
    if (tally.without_height < static_cast<std::int64_t>(observations.rows.size()))
        note(observations, "Positions from RMC, which have no height", tally.without_height);
    note(observations,
         "Epochs that are two-dimensional solutions, whose height was assumed and not measured",
         tally.in_plane);
    note(observations,
         "Epochs whose VTG speed is not that of RMC, whose own is used, because VTG does not say "
         "at which time it holds",
         tally.velocities_disagree);
    note(observations,
         "GST error ellipses that do not agree with the standard deviations beside them, which are "
         "used without a correlation",
         tally.ellipses_disagree);
}

/// What dates the recording: its own dates, or else the attempt's.
std::optional<FirstDay> first_day_of(const Receiver& receiver, const RecordingBytes& recording,
                                     Observations& observations) {
    const std::optional<FirstDay> recorded = find_first_day(recording);
    if (recorded) {
        observations.time_scale = "utc";
        if (recorded->without_fix)
            observations.notes.push_back(
                "The only dates in the recording are from epochs without a fix: they are those of "
                "the receiver's own clock, and may be wrong.");
        if (!receiver.start_date.empty())
            observations.notes.push_back(
                "The attempt's start_date is not used: the recording has dates of its own.");
        return recorded;
    }
    const std::optional<std::int64_t> day = attempted_day(receiver);
    if (!day) {
        observations.time_scale = "relative";
        observations.notes.push_back(
            "The recording has times of day and no date: start_date in the receiver would date "
            "it.");
        return std::nullopt;
    }
    observations.time_scale = "utc";
    observations.notes.push_back(fmt::format(
        "The recording has no date; the attempt's start_date is used: {}.", receiver.start_date));
    return FirstDay{.day = *day};
}

void require_position_sentences(const RecordingBytes& recording, const RowCollector& timed,
                                const Tally& tally) {
    if (!timed.empty() || timed.records().bad > 0) return;
    throw Failure(place_in(recording, 1, 1),
                  tally.without_time > 0
                      ? "the recording has NMEA sentences, and none of them has a time: the "
                        "receiver never found one"
                      : "the recording has no GGA, GNS or RMC sentences with a time, and so no "
                        "positions",
                  "Switch GGA, RMC and GST on in the receiver or logger, and record again under "
                  "open sky");
}

bool recognises(std::string_view bytes) {
    const RecordingBytes nameless{{}, bytes};
    std::int64_t unchecked = 0;
    try {
        SentenceReader sentences(nameless);
        while (const Sentence* sentence = sentences.next()) {
            if (sentence->damage != Damage::none) continue;
            if (sentence->has_checksum || ++unchecked > 1) return true;
        }
    } catch (const Failure&) {
        return false;  // a line that is too long: no text
    }
    return false;
}

/// The sentences of one talker, or of all.
Observations read_talker(const Receiver& receiver, const RecordingBytes& recording,
                         const std::optional<ChosenTalker>& chosen) {
    Observations observations = empty_observations("nmea", "geodetic", {});
    const std::optional<FirstDay> first = first_day_of(receiver, recording, observations);
    DayClock clock(first ? std::optional(first->day) : std::nullopt);
    RowCollector timed(recording);
    EpochReader epochs(recording, &timed, chosen);
    RowMaker maker(recording);
    std::int64_t without_position = 0;
    while (const auto epoch = epochs.next()) {
        if (!says_position(*epoch)) {
            ++without_position;
            continue;
        }
        const RecordPlace place = *solution_of(*epoch).place;
        try {
            const GpsTime instant = instant_of_record(recording, place, [&] {
                return clock.next(epoch->time_of_day_ns, day_of(*epoch, first));
            });
            timed.add(maker.row(*epoch, instant), place);
        } catch (const Failure& failure) {
            timed.count_bad(place, failure);
        }
    }
    if (!chosen)
        if (const auto one_of_several = epochs.tally().talkers.chosen())
            return read_talker(receiver, recording, one_of_several);
    require_position_sentences(recording, timed, epochs.tally());
    observations.variant = variant_of(epochs.tally().sentences);
    observations.device = epochs.tally().device;
    set_instrument(observations, epochs.tally().instrument);
    observations.simulated = epochs.tally().of_simulator > 0;
    if (observations.simulated)
        observations.written_by.push_back(
            fmt::format("{} sentences with quality 8 or mode S, those of a simulator",
                        epochs.tally().of_simulator));
    set_rows(observations, std::move(timed));
    note_sentences(observations, epochs.tally(), epochs.passed_over());
    if (chosen)
        observations.notes.push_back(fmt::format(
            "Positions of several talkers alternate, as of several receivers or solutions: those "
            "of {} are used, and {} sentences of others are not.",
            chosen->talker, epochs.tally().of_other_talkers));
    note(observations, "Times that have no GGA, GNS or RMC sentence, and are no epochs",
         without_position);
    note_rows(observations, maker.tally());
    fill_heights(observations);
    apply_attempt(observations, receiver);
    note_text(observations, recording);
    return observations;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    return read_talker(receiver, recording, std::nullopt);
}

}  // namespace

extern const Format format{
    .name = "nmea",
    .what = "NMEA 0183",
    .place = 100,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the receiver's position sentences",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::nmea
