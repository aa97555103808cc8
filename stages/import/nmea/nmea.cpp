#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "stages/import/clock.h"
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
    return FirstDay{
        .day = std::max_element(first_days.begin(), first_days.end(),
                                [](const auto& a, const auto& b) { return a.second < b.second; })
                   ->first};
}

/// The day that an epoch says it is on, days since 1980-01-06; nothing where it says none that
/// counts.
std::optional<std::int64_t> day_of(const Epoch& epoch, const std::optional<FirstDay>& first) {
    if (!epoch.date || !first || !(first->without_fix || has_fix(epoch))) return std::nullopt;
    return *epoch.date;
}

/// "NMEA 0183 with GGA, RMC, GST".
std::string variant_of(unsigned sentences) {
    std::string text = "NMEA 0183 with ";
    std::string_view separator;
    for (std::size_t i = 0; i < sentence_kinds.size(); ++i) {
        if (!((sentences >> i) & 1U)) continue;
        text += separator;
        text += sentence_kinds[i].word;
        separator = ", ";
    }
    return text;
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
        const RecordPlace place = place_of(*epoch);
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
    .of_satellites = true,
    .time_origin = "UTC of the receiver's position sentences",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::nmea
