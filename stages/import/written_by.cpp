#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "stages/import/import.h"
#include "stages/import/recording.h"

namespace runcert {
namespace {

// Words by which a file says who wrote it, in small letters, a blank standing for any run of what
// parts words; the letters before a word's first blank are looked for first.

constexpr std::string_view marks_of_simulators[] = {
    // English and what has its stem; Russian without the first letter, which may be a large one
    // (UTF-8, Windows-1251); Greek, Japanese, Chinese, Korean, Arabic.
    "simul", "emulat", "synthetic", "mocklocation", "mock location", "fakegps", "fake gps", "имул",
    "ИМУЛ", "митац", "МИТАЦ", "\xe8\xec\xf3\xeb\xff", "\xc8\xcc\xd3\xcb\xdf", "ροσομο", "シミュ",
    "模拟", "模擬", "仿真", "시뮬", "محاكا",
    // Simulators and generators; lconfpl is Condor, in L records of IGC.
    "nmeagen", "nmea-gen", "nmea generator", "track generator", "gps-sdr-sim", "skydel", "spirent",
    "labsat", "x-plane", "flightgear", "prepar3d", "assetto corsa", "iracing", "rfactor",
    "lconfpl"};

constexpr std::string_view marks_of_programs[] = {
    // Converters, editors, and programs that solve.
    "gpsbabel", "gpsprune", "google earth", "basecamp", "mapsource", "gpsvisualizer",
    "gps visualizer", "gpx editor", "gpx.studio", "gpxsee", "qmapshack", "routeconverter", "rtklib",
    "rtkpost", "rtkconv", "rnx2rtkp", "convbin", "gfzrnx", "exiftool", "libreoffice", "openoffice",
    "matlab",
    // What programs say of themselves.
    "creator", "created by", "created with", "created using", "created in", "written by",
    "written with", "made by", "made with", "produced by", "produced with", "modified by",
    "modified with", "generated", "generator", "converted", "converter", "exported", "edited",
    "resampled", "program ", "software ", "pgm / run by", "generiert", "konvertiert", "exportiert",
    "bearbeitet", "erstellt mit", "erzeugt mit", "converti ", "convertido", "exportado", "exporté",
    "generado", "généré", "créé par", "créé avec"};

constexpr std::size_t shortest_run = 4;
constexpr std::size_t lines_at_most = 8;
constexpr std::size_t shown_before = 60, shown_after = 100;

char small(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_ascii_letter(char c) {
    return small(c) >= 'a' && small(c) <= 'z';
}

bool parts_words(char c) {
    return std::string_view(" \t_-=:\"'>").find(c) != std::string_view::npos;
}

/// Where a mark that begins at `at` ends; npos where none does.
std::size_t end_of_mark(std::string_view bytes, std::size_t at, std::string_view mark) {
    for (const char c : mark) {
        if (c == ' ') {
            const std::size_t from = at;
            while (at < bytes.size() && parts_words(bytes[at]))
                ++at;
            if (at == from) return std::string_view::npos;
        } else if (at < bytes.size() && small(bytes[at]) == c) {
            ++at;
        } else {
            return std::string_view::npos;
        }
    }
    return at;
}

bool is_one_of(std::string_view text, std::initializer_list<std::string_view> words) {
    return std::ranges::find(words, text) != words.end();
}

/// Whether words about simulation say that there was none: "not simulated", "Simulation mode: off";
/// "simultaneous" is no word about it.
bool is_denied(std::string_view mark, std::string_view before, std::string_view after) {
    if (small(after.empty() ? ' ' : after.front()) == 't') return true;
    // A column's name says nothing: what it holds does (csv/), or the value beside it.
    if (mark.starts_with("mock")) {
        const std::string_view rest =
            after.substr(std::min(after.find_first_not_of("\"') "), after.size()));
        const bool is_name = rest.empty() || std::string_view(",;\t\r\n|").find(rest.front()) !=
                                                 std::string_view::npos;
        const std::string value = lower_case(rest.substr(std::min<std::size_t>(rest.size(), 1), 4));
        if (is_name && !value.starts_with("true") && !value.starts_with("1")) return true;
    }
    const std::string left =
        lower_case(before.substr(before.size() - std::min<std::size_t>(before.size(), 9)));
    // Loggers speak each other's protocols: "RaceBox protocol emulation", "emulates the protocol".
    if (mark == "emulat" &&
        (left.ends_with("protocol ") ||
         lower_case(after.substr(0, after.find_first_of("\r\n"))).find("protocol") !=
             std::string::npos))
        return true;
    for (const std::string_view no : {"not ", "no ", "non ", "non-", "kein ", "keine "})
        if (left.ends_with(no) &&
            (left.size() == no.size() || !is_ascii_letter(left[left.size() - no.size() - 1])))
            return true;
    // "Simulated: no", and not "simulated, seed: 0".
    const std::string right = lower_case(after.substr(0, after.find_first_of("\r\n")));
    const std::size_t word =
        static_cast<std::size_t>(std::ranges::find_if_not(right, is_ascii_letter) - right.begin());
    const std::size_t colon = std::min(right.find_first_of(":=", word), right.size());
    const std::string_view between = trim(std::string_view(right).substr(word, colon - word));
    std::string_view value = std::string_view(right).substr(colon);
    value.remove_prefix(std::min(value.find_first_not_of(":= \t\"'"), value.size()));
    return is_one_of(between, {"", "mode", "flag", "enabled", "active"}) &&
           is_one_of(value.substr(0, value.find_first_of(" \t,;\"'<")),
                     {"no", "off", "false", "0", "none", "n", "nein", "non"});
}

/// What is found in one file.
class Finder {
  public:
    explicit Finder(const RecordingBytes& file)
        : file_(file),
          bytes_(file.bytes),
          binary_(bytes_.substr(0, recognised_by).find('\0') != std::string_view::npos) {}

    void read() {
        for (std::size_t at = 0; at < bytes_.size(); ++at) {
            if (!is_letter(bytes_[at])) continue;
            const std::size_t start = at;
            while (at < bytes_.size() && is_letter(bytes_[at]))
                ++at;
            if (at - start >= shortest_run) look(start, at);
            if (file_.passed && at - passed_ > passed_by) file_.passed(passed_ = start);
        }
    }

    void see(std::string text, bool of_simulator) {
        if (std::ranges::find(lines, text) != lines.end()) return;
        // A line that names a simulator always finds room.
        if (lines.size() == lines_at_most && of_simulator) lines.pop_back();
        if (lines.size() < lines_at_most) lines.push_back(std::move(text));
    }

    std::vector<std::string> lines;
    bool simulated = false;

  private:
    static constexpr std::size_t passed_by = std::size_t{16} << 20;

    /// In text also the bytes of letters that ASCII does not have.
    bool is_letter(char c) const {
        return is_ascii_letter(c) || c == '-' || (!binary_ && static_cast<signed char>(c) < 0);
    }

    void look(std::size_t start, std::size_t end) {
        const std::string run = lower_case(bytes_.substr(start, end - start));
        for (const std::string_view mark : marks_of_simulators)
            if (const auto at = find_mark(start, run, mark);
                at &&
                !is_denied(mark, bytes_.substr(0, at->first), bytes_.substr(at->second, 32))) {
                simulated = true;
                return show(*at, true);
            }
        for (const std::string_view mark : marks_of_programs)
            if (const auto at = find_mark(start, run, mark)) return show(*at, false);
    }

    using Place = std::pair<std::size_t, std::size_t>;

    /// Where a mark begins and ends in the run of letters from `start` on.
    std::optional<Place> find_mark(std::size_t start, std::string_view run,
                                   std::string_view mark) const {
        const std::size_t found = run.find(mark.substr(0, mark.find(' ')));
        if (found == std::string_view::npos) return std::nullopt;
        const std::size_t to = end_of_mark(bytes_, start + found, mark);
        if (to == std::string_view::npos) return std::nullopt;
        return Place(start + found, to);
    }

    void show(const Place& at, bool of_simulator) {
        if (at.first >= shown_to_) see(around(at.first, at.second), of_simulator);
    }

    /// The line, shortened: of binary files what of it is text.
    std::string around(std::size_t from, std::size_t to) {
        const auto ends = [&](char c) { return static_cast<unsigned char>(c) < ' ' && c != '\t'; };
        std::size_t begin = from;
        while (begin > 0 && from - begin < shown_before && !ends(bytes_[begin - 1]))
            --begin;
        std::size_t end = to;
        while (end < bytes_.size() && end - to < shown_after && !ends(bytes_[end]))
            ++end;
        const auto continues = [&](std::size_t at) {
            return at < bytes_.size() && (static_cast<unsigned char>(bytes_[at]) & 0xC0U) == 0x80U;
        };
        while (begin < from && continues(begin))
            ++begin;
        while (end > to && continues(end))
            --end;
        shown_to_ = end;
        return escape_for_message(trim(bytes_.substr(begin, end - begin)), 400);
    }

    const RecordingBytes& file_;
    std::string_view bytes_;
    bool binary_;
    std::size_t passed_ = 0;
    std::size_t shown_to_ = 0;  ///< of the line that was taken last
};

}  // namespace

void note_written_by(const RecordingBytes& file, bool named, Observations& observations) {
    if (is_utf16(file.bytes)) {
        const std::string text = utf8_of_utf16(file);
        return note_written_by({.name = file.name, .bytes = text}, named, observations);
    }
    Finder finder(file);
    finder.read();
    observations.simulated |= finder.simulated;
    for (const std::string& line : finder.lines) {
        if (!observations.device.empty() && line.find(observations.device) != std::string::npos)
            continue;
        const std::string name = file.name.substr(file.name.find_last_of('/') + 1);
        observations.written_by.push_back(
            named ? fmt::format("{}: {}", escape_for_message(name, 120), line) : line);
    }
}

}  // namespace runcert
