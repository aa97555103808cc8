#pragma once

#include <string>
#include <vector>

#include "handover_support.h"
#include "hostile_support.h"

// An attempt, a profile and a recording whose free fields hold what a page, a terminal, a
// spreadsheet or a shell could take for its own.

namespace runcert::chain {

/// As it stands between double quotes in YAML, and as it must be shown.
inline const std::string markup_in_yaml =
    "</script><script>document.title='taken'</script><!-- <b onmouseover=alert(1)>\\\"'`"
    "{{report_id}}{{{style}}}{{#signed}} &lt;i&gt;&#x202e;&amp; \\\\u003c \\\\x1b[31m";
inline const std::string markup =
    "</script><script>document.title='taken'</script><!-- <b onmouseover=alert(1)>\"'`"
    "{{report_id}}{{{style}}}{{#signed}} &lt;i&gt;&#x202e;&amp; \\u003c \\x1b[31m";
/// A line that says what is not true. What cannot be seen is refused when an attempt is read, see
/// AttacksOnTexts; the recording below has some of it.
inline const std::string steering_in_yaml = " \\n\\tVERIFIED\\n";
inline const std::string letters =
    "\u26F5\U0001F3F4\u2620 e\u0301\u0323 Z\u0311\u0343\u0311\u0343 "
    "\u05E9\u05DC\u05D5\u05DD \u0645\u0631\u062D\u0628\u0627";
inline const std::string long_word(10000, 'W');

/// A hostile text with a word of its own, in YAML.
inline std::string hostile(const std::string& tag, const char* begin = "=") {
    return fmt::format("\"{}cmd() {} {} {} {}\"", begin, tag, markup_in_yaml, letters,
                       steering_in_yaml);
}

inline std::string endless(const std::string& tag) {
    return fmt::format("{}{}", tag, long_word);
}

/// Words of the fields that the report shows, with the markup.
inline const std::vector<std::string> tags{"CRAFT",  "ROLE",   "NAME",       "RECORD",
                                           "REASON", "AMENDS", "METHOD",     "BODY",
                                           "TITLE",  "CLAUSE", "CLAUSETEXT", "CLAUSESOURCE"};
inline const std::vector<std::string> endless_tags{"PLACE", "OTHERNAME", "OTHERREASON",
                                                   "ATTESTTEXT"};

inline const std::string hostile_recording =
    "=cmd() <script>alert(1)<\\script> $(touch owned) {{style}} `touch owned`.pos";
/// A clause that is not met, whose name a shell would run.
inline const std::string shell_clause = "a'; touch owned; $(touch owned)";

inline std::string hostile_profile() {
    return fmt::format(
        "schema: profile/1.0\nid: own\nbody: {}\ntitle: {}\n"
        "window: {{kind: time, duration_s: 3, definition: displacement}}\n"
        "margin: {{kind: absolute, value: 1, unit: km/h}}\n"
        "signatures: [{{role: judge}}]\n"
        "clauses:\n"
        "  - {{id: {}, text: {}, source: {}, certainty: quoted, decided_by: window_complete}}\n"
        "  - {{id: attested, text: {}, source: s, certainty: unconfirmed, decided_by: attest}}\n"
        "  - {{id: \"{}\", text: t, source: s, certainty: secondary, decided_by: margin}}\n",
        hostile("BODY"), hostile("TITLE", "+"), hostile("CLAUSE", "-"), hostile("CLAUSETEXT", "@"),
        hostile("CLAUSESOURCE"), endless("ATTESTTEXT"), shell_clause);
}

inline std::string hostile_attempt() {
    std::string text = read_file(examples / "course" / "attempt.yaml");
    const auto replace = [&text](const std::string& what, const std::string& by) {
        text = replaced(text, what, by);
    };
    replace("simulated sailing boat, class", hostile("CRAFT") + ", class");
    replace("a canal beside the sea (simulated)", endless("PLACE"));
    replace("- {role: measurer}",
            fmt::format("- {{role: measurer, name: {}, key: {}}}\n  - {{role: {}, name: {}}}",
                        hostile("NAME", "+"), hostile("KEY"), hostile("ROLE", "@"),
                        endless("OTHERNAME")));
    replace("recording: recording.pos", "recording: '" + hostile_recording + "'");
    const std::size_t record = text.find("\nrecord: ") + 1;
    text.replace(record, text.find('\n', record) - record,
                 fmt::format("records:\n"
                             "  - {{profile: wssrc-500m, speed: 54.08, unit: kn, source: {}}}\n"
                             "  - {{profile: own, speed: 99, unit: kn, source: s}}\n"
                             "rules:\n"
                             "  - {{profile: wssrc-500m, figure: margin.value, value: 0.02, "
                             "reason: {}}}\n"
                             "  - {{profile: own, figure: margin.value, value: 2, reason: {}}}\n"
                             "amends: {{report_id: 0123456789abcdef, sha256: {}, reason: {}}}",
                             hostile("RECORD"), hostile("REASON"), endless("OTHERREASON"),
                             std::string(64, 'a'), hostile("AMENDS")));
    replace("[wssrc-500m]", "[wssrc-500m, own.yaml]");
    replace("anemometer at the middle of the course", hostile("WIND"));
    replace("drifting float beside the course", hostile("CURRENT", "-"));
    replace("video at both lines", hostile("METHOD"));
    replace("timekeeper's sheet", hostile("METHODSOURCE"));
    return text;
}

/// Puts attempt, profile and recording into a folder.
inline void write_hostile_attempt(const fs::path& folder) {
    fs::copy(examples / "course", folder, fs::copy_options::recursive);
    fs::remove(folder / "recording.pos");
    write_plainly(folder / hostile_recording,
                  replaced(read_file(examples / "course" / "recording.pos"), "no receiver",
                           "<script>alert(1)</script> \x1b[31m \u202E {{x}}"));
    write_plainly(folder / "own.yaml", hostile_profile());
    write_plainly(folder / "attempt.yaml", hostile_attempt());
}

/// Control characters but the line feed, and what turns the direction of writing, as bytes.
inline std::vector<std::string> steering_in(const std::string& text) {
    static const std::vector<std::string> marks{"\u061C", "\u200E", "\u200F", "\u2028", "\u2029",
                                                "\u202A", "\u202B", "\u202C", "\u202D", "\u202E",
                                                "\u2066", "\u2067", "\u2068", "\u2069"};
    std::vector<std::string> found;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const bool c1 =
            byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
        if ((byte < 0x20 && byte != '\n') || byte == 0x7F || c1)
            found.push_back(fmt::format("{:02x} at {}", byte, i));
    }
    for (const std::string& mark : marks)
        if (text.find(mark) != std::string::npos) found.push_back(mark);
    return found;
}

}  // namespace runcert::chain
