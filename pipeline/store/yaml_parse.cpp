#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>

#include "core/failure.h"
#include "core/text.h"
#include "store/yaml_input.h"

namespace runcert {
namespace {

void refuse_other_encodings(std::string_view text, const std::string& where) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        throw Failure(where, "the file is UTF-16 text", "Save it as UTF-8");
    const std::size_t nul = text.find('\0');
    if (nul != std::string_view::npos)
        throw Failure(where, fmt::format("byte {} is zero: this is not a text file", nul),
                      "Save it as UTF-8 text");
}

/// A lone carriage return, and some characters beyond ASCII, are taken for a line's end by some
/// readers of YAML.
void refuse_unprintable_lines(std::string_view text, const std::string& where) {
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view content = text.substr(0, end);
        if (content.ends_with('\r')) content.remove_suffix(1);
        if (!is_printable_ascii(content) && !is_printable_line(content))
            throw Failure(
                fmt::format("{}:{}:1", where, line),
                "the line holds characters that are not seen, or bytes that are not UTF-8",
                "Save the file as UTF-8 text, without such characters");
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

bool is_null_word(std::string_view text) {
    return text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL";
}

/// Builds a document from its events, and refuses what would make it large or ambiguous.
class StrictDocument : public YAML::EventHandler {
  public:
    StrictDocument(std::string_view text, const std::string& where) : text_(text), where_(where) {}

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (++documents_ > 1)
            refuse(mark, "the file holds more than one YAML document",
                   "Keep one, without further `---` lines, and check the indentation there");
    }
    void OnDocumentEnd() override {}
    void OnAnchor(const YAML::Mark& mark, const std::string&) override { refuse_alias(mark); }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_alias(mark); }
    void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { take_null(mark); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  const std::string& value) override {
        check(mark, tag);
        const bool is_quoted = tag == "!";
        if (!is_quoted && is_null_word(value)) return take_null(mark);
        last_ = static_cast<std::size_t>(mark.pos);
        // The parser takes the end of a text that ends with a line feed for that of a quote, too.
        const std::size_t quote = is_quoted ? require_closed(last_) : last_;
        const bool is_key = builder_.is_at_key();
        builder_.scalar(value, is_quoted, place(mark));
        value_place_.reset();
        if (is_key) take_colon(mark, quote > last_ ? quote + 1 : last_ + value.size());
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                         YAML::EmitterStyle::value style) override {
        begin(YamlKind::list, mark, tag, style);
    }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                    YAML::EmitterStyle::value style) override {
        begin(YamlKind::map, mark, tag, style);
    }
    void OnSequenceEnd() override { end(); }
    void OnMapEnd() override { end(); }

    /// A null node where there is none.
    YamlNode document() && { return builder_.is_empty() ? YamlNode() : std::move(builder_).take(); }

    [[noreturn]] void refuse(const YAML::ParserException& error) const {
        for (std::size_t at = last_; at < text_.size(); ++at) {
            if (text_[at] == '#' && at > 0 && is_blank(text_[at - 1]))
                at = std::min(text_.find('\n', at), text_.size());
            else if (at == last_ || is_before_value(text_[at - 1]))
                at = require_closed(at);
        }
        // Such is a question mark in a text without quotes, within braces.
        refuse(error.mark, "not valid YAML: " + error.msg,
               error.msg == YAML::ErrorMsg::UNKNOWN_TOKEN
                   ? "Put the text there in quotes"
                   : "Check indentation, colons and quotes there");
    }

  private:
    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
    static bool is_before_value(char c) {
        return is_blank(c) || c == '[' || c == '{' || c == ',' || c == ':';
    }

    /// Where the quoted text that begins there ends; the same place where none begins. Refused
    /// where it does not end.
    std::size_t require_closed(std::size_t begin) const {
        const char quote = begin < text_.size() ? text_[begin] : ' ';
        if (quote != '"' && quote != '\'') return begin;
        for (std::size_t at = begin + 1; at < text_.size(); ++at) {
            if (quote == '"' && text_[at] == '\\')
                ++at;
            else if (text_[at] == quote && (quote == '"' || text_.substr(at + 1, 1) != "'"))
                return at;
            else if (text_[at] == quote)
                ++at;
        }
        refuse(place_of(begin), "not valid YAML: a quote is not closed",
               "Check indentation, colons and quotes there");
    }

    [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what,
                             const std::string& remedy) const {
        refuse(place(mark), what, remedy);
    }
    static YamlMark place(const YAML::Mark& mark) {
        return {.line = mark.line, .column = mark.column};
    }
    [[noreturn]] void refuse(const YamlMark& at, const std::string& what,
                             const std::string& remedy) const {
        throw Failure(fmt::format("{}:{}:{}", where_, at.line + 1, at.column + 1), what, remedy);
    }
    [[noreturn]] void refuse_alias(const YAML::Mark& mark) const {
        refuse(mark, "YAML anchors and aliases are not read", "Write the value out in each place");
    }

    /// A tag that says what its value already is would need a check of its own: only those that
    /// astropy writes are read, and "!" and "?", which the parser gives to text with and without
    /// quotes.
    void check(const YAML::Mark& mark, std::string_view tag) const {
        constexpr std::string_view standard = "tag:yaml.org,2002:";
        const std::string_view kind = tag.starts_with(standard) ? tag.substr(standard.size()) : "";
        if (!tag.empty() && tag != "!" && tag != "?" && kind != "map" && kind != "seq" &&
            kind != "omap")
            refuse(mark, "the tag \"" + escape_for_message(tag) + "\" is not understood",
                   "Remove it");
    }
    [[noreturn]] void refuse_key(const YAML::Mark& mark) const {
        refuse(mark, "a key is not text", "Write one word as the key");
    }

    /// The value of a key, where nothing is said, stands behind its colon.
    void take_null(const YAML::Mark& mark) {
        if (builder_.is_at_key()) refuse_key(mark);
        const std::string_view rest =
            text_.substr(std::min(static_cast<std::size_t>(std::max(mark.pos, 0)), text_.size()));
        const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n,:#]}"));
        builder_.null(word.empty() || !is_null_word(word) ? value_place_.value_or(place(mark))
                                                          : place(mark));
        value_place_.reset();
    }

    /// The parser takes a line that lacks its colon for a key without a value.
    void take_colon(const YAML::Mark& key, std::size_t after_key) {
        const std::size_t colon = text_.find_first_not_of(" \t", after_key);
        if (colon != std::string_view::npos && text_[colon] == ':') {
            value_place_ = place(key);
            value_place_->column += static_cast<std::int32_t>(colon + 1 - last_);
            return;
        }
        const std::size_t before =
            last_ == 0 ? std::string_view::npos : text_.find_last_not_of(" \t", last_ - 1);
        const bool is_marked = before != std::string_view::npos && text_[before] == '?';
        if (!is_marked && !in_braces_.back())
            refuse(key, "not valid YAML: a colon is missing",
                   "Check indentation, colons and quotes there");
    }

    YamlMark place_of(std::size_t byte) const {
        const std::size_t line = byte == 0 ? std::string_view::npos : text_.rfind('\n', byte - 1);
        return {.line = static_cast<std::int32_t>(std::ranges::count(text_.substr(0, byte), '\n')),
                .column = static_cast<std::int32_t>(
                    byte - (line == std::string_view::npos ? 0 : line + 1))};
    }

    void begin(YamlKind kind, const YAML::Mark& mark, std::string_view tag,
               YAML::EmitterStyle::value style) {
        constexpr std::size_t deepest = 32;
        if (builder_.is_at_key()) refuse_key(mark);
        check(mark, tag);
        if (builder_.depth() == deepest)
            refuse(mark, "the document is nested deeper than 32 levels",
                   "No file of this program is; check what this file is");
        builder_.begin(kind, place(mark), tag == "tag:yaml.org,2002:omap");
        in_braces_.push_back(style == YAML::EmitterStyle::Flow);
        value_place_.reset();
    }

    void end() {
        in_braces_.pop_back();
        if (const auto key = builder_.end())
            refuse(key->mark,
                   "the key \"" + escape_for_message(key->text) + "\" stands twice in one map",
                   "Keep one of the two");
    }

    std::string_view text_;
    const std::string& where_;
    std::size_t last_ = 0;                 ///< where the scalar read last begins
    std::vector<bool> in_braces_;          ///< of each list and map that is begun and not ended
    std::optional<YamlMark> value_place_;  ///< behind the colon of the key just read
    int documents_ = 0;
    YamlBuilder builder_;
};

}  // namespace

YamlNode parse_yaml(std::string_view text, const std::string& where) {
    refuse_other_encodings(text, where);
    if (text.starts_with(utf8_mark)) text.remove_prefix(utf8_mark.size());
    refuse_unprintable_lines(text, where);
    StrictDocument document(text, where);
    try {
        std::istringstream stream{std::string(text)};
        YAML::Parser parser(stream);
        if (parser.HandleNextDocument(document)) parser.HandleNextDocument(document);
    } catch (const YAML::ParserException& error) {
        document.refuse(error);
    }
    YamlNode root = std::move(document).document();
    if (root.is_null()) throw Failure(where, "the file is empty", "Give the file its content back");
    return root;
}

}  // namespace runcert
