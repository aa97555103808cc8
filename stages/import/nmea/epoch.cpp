#include "stages/import/nmea/epoch.h"

#include <utility>

#include "core/text.h"
#include "stages/import/nmea/sentence_content.h"

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
void name_device(const Sentence& sentence, std::string& device) {
    constexpr std::size_t longest = 120;
    const std::string_view text = trim(sentence[4]);
    const bool names = text.starts_with("HW ") || text.starts_with("MOD=") ||
                       text.starts_with("FWVER=") || text.starts_with("ROM ");
    if (!names || !is_printable_ascii(text) || device.find(text) != std::string::npos ||
        device.size() + text.size() > longest)
        return;
    device += device.empty() ? "u-blox " : ", ";
    device += text;
}

}  // namespace

std::optional<Epoch> EpochReader::next() {
    for (;;) {
        const Sentence* sentence = held_ ? std::exchange(held_, nullptr) : sentences_.next();
        if (!sentence) return std::exchange(epoch_, std::nullopt);
        if (sentence->damage != Damage::none) {
            count_damaged(*sentence);
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
    if (sentence.type == SentenceType::txt) return name_device(sentence, tally_.device);
    require_whole(sentence);
    tally_.sentences |= bit(sentence.type);
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

}  // namespace runcert::nmea
