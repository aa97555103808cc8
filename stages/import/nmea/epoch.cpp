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
            add_sentence(*sentence);
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

void EpochReader::add_sentence(const Sentence& sentence) {
    if (sentence.type == SentenceType::txt) return name_device(sentence, tally_);
    require_whole(sentence);
    tally_.sentences |= bit(sentence.type);
    tally_.talkers.see(sentence);
    if (is_of_simulator(sentence)) ++tally_.of_simulator;
    const bool timed = has_time_field(sentence.type);
    if (timed && sentence[1].empty()) {
        ++tally_.without_time;
    } else {
        if (timed && !epoch_) {
            epoch_.emplace();
            epoch_->time_of_day_ns = time_of_day_ns_;
            epoch_->time_text = sentence[1];
        }
        if (epoch_ && !is_repeated(sentence)) {
            nmea::add_sentence(sentence, *epoch_);
            if (sentence.type == SentenceType::gga && epoch_->gga.fix == FixType::unknown &&
                !sentence[6].empty())
                ++tally_.odd_qualities;
        }
    }
    if (!sentence.has_checksum) ++tally_.without_checksum;
    if (counts_) counts_->count_good();
}

const Solution& solution_of(const Epoch& epoch) {
    for (const Solution* solution : {&epoch.gga, &epoch.gns, &epoch.rmc})
        if (solution->position) return *solution;
    return epoch.gga.given ? epoch.gga : (epoch.gns.given ? epoch.gns : epoch.rmc);
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

}  // namespace runcert::nmea
