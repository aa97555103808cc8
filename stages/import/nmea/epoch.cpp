#include "stages/import/nmea/epoch.h"

#include <cmath>
#include <utility>

#include "core/text.h"
#include "stages/import/earth.h"

namespace runcert::nmea {
namespace {

constexpr unsigned bit(SentenceType type) {
    return 1U << static_cast<unsigned>(type);
}

bool has_time_field(SentenceType type) {
    return type != SentenceType::vtg && type != SentenceType::gsa && type != SentenceType::txt;
}

/// Whether a sentence says that a simulator made its position (NMEA 0183 4.1: quality 8, mode S).
bool is_of_simulator(const Sentence& sentence) {
    switch (sentence.type) {
        case SentenceType::gga:
            return sentence[6] == "8";
        case SentenceType::gns:
            return sentence[6].find('S') != std::string_view::npos;
        case SentenceType::rmc:
            return sentence[12] == "S";
        case SentenceType::vtg:
            return sentence[9] == "S";
        default:
            return false;
    }
}

/// Adds what a TXT sentence says of the device: u-blox receivers name theirs when switched on.
void name_device(const Sentence& sentence, Tally& tally) {
    constexpr std::size_t longest = 120;
    std::string& device = tally.device;
    const std::string_view text = trim(sentence[4]);
    const bool names = text.starts_with("HW ") || text.starts_with("MOD=") ||
                       text.starts_with("FWVER=") || text.starts_with("ROM ");
    if (!names || !is_printable_ascii(text) || device.find(text) != std::string::npos ||
        device.size() + text.size() > longest)
        return;
    device += device.empty() ? "u-blox " : ", ";
    device += text;
    tally.instrument.make = "u-blox";
    if (text.starts_with("MOD=")) tally.instrument.model = trim(text.substr(4));
    if (text.starts_with("FWVER=")) tally.instrument.firmware = trim(text.substr(6));
}

/// Of GGA, GNS and RMC, in this order, the first with a position; else the first that is there.
const Solution& solution_of(const Epoch& epoch) {
    for (const Solution* solution : {&epoch.gga, &epoch.gns, &epoch.rmc})
        if (solution->position) return *solution;
    return epoch.gga.given ? epoch.gga : (epoch.gns.given ? epoch.gns : epoch.rmc);
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

}  // namespace

void Talkers::see(const Sentence& sentence) {
    constexpr std::size_t size = 2;
    const std::string_view talker = sentence[0].substr(0, size);
    OfType& type = types_[static_cast<std::size_t>(sentence.type)];
    ++type.count[talker];
    if (!type.last.empty() && type.last != talker) ++type.changes;
    type.last = talker;
}

std::optional<ChosenTalker> Talkers::chosen() const {
    constexpr std::int64_t least_changes = 5;
    for (const SentenceType positions : {SentenceType::gga, SentenceType::gns, SentenceType::rmc}) {
        const OfType& type = types_[static_cast<std::size_t>(positions)];
        std::int64_t all = 0;
        std::string_view most;
        for (const auto& [talker, count] : type.count) {
            all += count;
            // Of as many the one of all systems.
            const std::int64_t best = most.empty() ? 0 : type.count.at(most);
            if (count > best || (count == best && talker == "GN")) most = talker;
        }
        if (type.changes < least_changes || 4 * type.changes <= all) continue;
        ChosenTalker chosen{.talker = most};
        for (std::size_t i = 0; i < types_.size(); ++i)
            if (types_[i].count.contains(most)) chosen.types |= 1U << i;
        return chosen;
    }
    return std::nullopt;
}

bool EpochReader::is_of_other_talker(const Sentence& sentence) const {
    return chosen_ && (chosen_->types & bit(sentence.type)) != 0 &&
           !sentence[0].starts_with(chosen_->talker);
}

std::optional<Epoch> EpochReader::next() {
    for (;;) {
        const Sentence* sentence = held_ ? std::exchange(held_, nullptr) : sentences_.next();
        if (!sentence) return std::exchange(epoch_, std::nullopt);
        if (sentence->damage != Damage::none) {
            count_damaged(*sentence);
            continue;
        }
        if (is_of_other_talker(*sentence)) {
            ++tally_.of_other_talkers;
            if (counts_) counts_->count_good();
            continue;
        }
        try {
            if (begins_next_epoch(*sentence)) {
                held_ = sentence;
                return std::exchange(epoch_, std::nullopt);
            }
            take_in(*sentence);
        } catch (const Failure& failure) {
            count_bad(*sentence, failure);
        }
    }
}

void EpochReader::count_bad(const Sentence& sentence, const Failure& why) {
    if (counts_) counts_->count_bad(sentence.line, why, epoch_.has_value());
}

void EpochReader::count_damaged(const Sentence& sentence) {
    // Of a file of nothing but these, only those that are listed are worth a message each.
    static const Failure unlisted("", "", "");
    if (!counts_) return;
    const bool listed = counts_->records().bad_records.size() < bad_records_listed_at_most;
    count_bad(sentence, listed ? failure_of(sentence) : unlisted);
}

bool EpochReader::begins_next_epoch(const Sentence& sentence) {
    if (!has_time_field(sentence.type) || sentence[1].empty()) return false;
    time_of_day_ns_ = read_time_of_day(sentence.cell(1));
    return epoch_ && epoch_->time_of_day_ns != time_of_day_ns_;
}

/// Whether the epoch has such a sentence already; it has one from now on. Several GSA are usual:
/// one for each system of satellites.
bool EpochReader::is_repeated(const Sentence& sentence) {
    const bool repeated = epoch_->has(sentence.type) && sentence.type != SentenceType::gsa;
    epoch_->sentences |= bit(sentence.type);
    if (repeated) ++tally_.repeated;
    return repeated;
}

void EpochReader::take_in(const Sentence& sentence) {
    if (sentence.type == SentenceType::txt) return name_device(sentence, tally_);
    require_whole(sentence);
    tally_.sentences |= bit(sentence.type);
    tally_.talkers.see(sentence);
    if (is_of_simulator(sentence)) ++tally_.of_simulator;
    if (has_time_field(sentence.type)) {
        if (sentence[1].empty())
            ++tally_.without_time;
        else
            take_in_timed(sentence);
    } else if (epoch_ && !is_repeated(sentence)) {
        if (sentence.type == SentenceType::vtg)
            epoch_->vtg_velocity = read_vtg(sentence);
        else
            take_in_gsa(sentence, *epoch_);
    }
    if (!sentence.has_checksum) ++tally_.without_checksum;
    if (counts_) counts_->count_good();
}

void EpochReader::take_in_timed(const Sentence& sentence) {
    if (!epoch_) {
        epoch_.emplace();
        epoch_->time_of_day_ns = time_of_day_ns_;
        epoch_->time_text = sentence[1];
    }
    if (is_repeated(sentence)) return;
    switch (sentence.type) {
        case SentenceType::gga:
            epoch_->gga = read_gga(sentence);
            if (epoch_->gga.fix == FixType::unknown && !sentence[6].empty()) ++tally_.odd_qualities;
            return;
        case SentenceType::gns:
            epoch_->gns = read_gns(sentence);
            return;
        case SentenceType::rmc:
            take_in_rmc(sentence, *epoch_);
            return;
        case SentenceType::gst:
            epoch_->errors = read_gst(sentence);
            return;
        case SentenceType::zda:
            if (!sentence[2].empty() && !epoch_->date)
                epoch_->date = read_date(sentence.cell(2), sentence.cell(3), sentence.cell(4));
            return;
        case SentenceType::vtg:
        case SentenceType::gsa:
        case SentenceType::txt:
            return;
    }
}

bool says_position(const Epoch& epoch) {
    return epoch.gga.given || epoch.gns.given || epoch.rmc.given;
}

bool has_fix(const Epoch& epoch) {
    for (const Solution* solution : {&epoch.gga, &epoch.gns, &epoch.rmc})
        if (solution->given && solution->fix == FixType::none) return false;
    if (epoch.satellite_lists > 0 && epoch.satellite_lists == epoch.satellite_lists_without_fix)
        return false;
    return solution_of(epoch).position.has_value();
}

RecordPlace place_of(const Epoch& epoch) {
    return *solution_of(epoch).place;
}

std::optional<double> RowMaker::known_separation_m() {
    if (separation_m_ || std::exchange(looked_for_, true)) return separation_m_;
    EpochReader epochs(recording_, nullptr);
    while (const auto epoch = epochs.next())
        for (const Solution* solution : {&epoch->gga, &epoch->gns})
            if (solution->has_height && solution->separation_m.value_or(0.0) != 0.0)
                return separation_m_ = *solution->separation_m;
    return std::nullopt;
}

void RowMaker::set_solution(TimedRow& row, const Solution& solution) {
    set_position(row.observation, *solution.position);
    if (solution.has_height && solution.separation_m.value_or(0.0) != 0.0) {
        separation_m_ = *solution.separation_m;
    } else if (const auto separation_m = solution.has_height ? known_separation_m() : std::nullopt;
               separation_m && (solution.above_sea_level || std::abs(*separation_m) > 1.0)) {
        row.observation.height_m = *row.observation.height_m + *separation_m;
        ++tally_.separation_of_another;
        --tally_.above_sea_level;
        if (!solution.above_sea_level) ++tally_.above_sea_level;
    }
    if (!solution.has_height) {
        row.observation.height_m.reset();
        ++tally_.without_height;
    }
    if (solution.above_sea_level) ++tally_.above_sea_level;
    row.written.unit = CoordinateUnit::arc_minute;
    row.written.coordinates = {solution.coordinates[0], solution.coordinates[1], {}};
}

void RowMaker::set_ground_velocity(Observation& row, const Epoch& epoch) {
    const GroundVelocity &vtg = epoch.vtg_velocity, &rmc = epoch.rmc_velocity;
    const bool both = vtg.speed_m_s.value && rmc.speed_m_s.value;
    const bool disagree = both && !agree(vtg.speed_m_s, rmc.speed_m_s);
    if (disagree) ++tally_.velocities_disagree;
    const WrittenNumber& speed_m_s = disagree ? rmc.speed_m_s : finer(vtg.speed_m_s, rmc.speed_m_s);
    const WrittenNumber& course_deg =
        disagree ? rmc.course_deg : finer(vtg.course_deg, rmc.course_deg);
    if (speed_m_s.value) set_speed(row, *speed_m_s.value, course_of(course_deg.value));
}

void RowMaker::set_errors(Observation& row, const ErrorStatistics& errors) {
    row.sigma_north_m = errors.sigma_north_m.value;
    row.sigma_east_m = errors.sigma_east_m.value;
    if (row.height_m) row.sigma_up_m = errors.sigma_up_m;
    if (!row.sigma_north_m || !row.sigma_east_m || !errors.semi_major_m.value ||
        !errors.semi_minor_m.value || !errors.orientation_deg)
        return;
    row.correlation_east_north = correlation_of_ellipse(errors);
    if (!row.correlation_east_north) ++tally_.ellipses_disagree;
}

TimedRow RowMaker::row(const Epoch& epoch, GpsTime instant) {
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
    if (epoch.satellite_lists > 0 && epoch.satellite_lists_in_plane > 0) ++tally_.in_plane;
    set_solution(row, solution);
    set_ground_velocity(row.observation, epoch);
    set_errors(row.observation, epoch.errors);
    return row;
}

}  // namespace runcert::nmea
