#include <fmt/format.h>
#include <yaml.h>

#include <algorithm>

#include "core/failure.h"
#include "core/plain_text.h"
#include "core/text.h"
#include "files/yaml_input.h"

namespace runcert {
namespace {

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

void refuse_other_encodings(std::string_view text, const std::string& where) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        throw Failure(where, "the file is UTF-16 text", "Save it as UTF-8");
    const std::size_t nul = text.find('\0');
    if (nul != std::string_view::npos)
        throw Failure(where, fmt::format("byte {} is zero: this is not a text file", nul),
                      "Save it as UTF-8 text");
}

/// The parser takes a lone carriage return, and some characters beyond ASCII, for a line's end.
void refuse_unprintable_lines(std::string_view text, const std::string& where) {
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view content = text.substr(0, end);
        if (content.ends_with('\r')) content.remove_suffix(1);
        if (!is_printable_ascii(content) && !is_printable_line(content))
            throw Failure(fmt::format("{}:{}:1", where, line),
                          "the line holds control characters, or bytes that are not UTF-8",
                          "Save the file as UTF-8 text, without such characters");
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

bool is_ascii(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

bool is_null_word(std::string_view text) {
    return text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL";
}

std::string_view text_of(const yaml_char_t* text) {
    return text ? std::string_view(reinterpret_cast<const char*>(text)) : std::string_view();
}

/// Places in bytes; libyaml counts characters.
class Places {
  public:
    Places(std::string_view text, const std::string& where) : text_(text), where_(where) {
        if (is_ascii(text)) return;
        lines_.push_back(0);
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string_view::npos;)
            lines_.push_back(++at);
    }

    YamlMark mark(const yaml_mark_t& found) const {
        std::size_t column = found.column;
        // libyaml puts the end of a text that lacks its last line feed on a line of its own.
        if (found.line < lines_.size()) column = offset(found) - lines_[found.line];
        return {.line = static_cast<std::int32_t>(found.line),
                .column = static_cast<std::int32_t>(column)};
    }

    [[noreturn]] void refuse(const YamlMark& at, const std::string& what,
                             const std::string& remedy) const {
        throw Failure(fmt::format("{}:{}:{}", where_, at.line + 1, at.column + 1), what, remedy);
    }

  private:
    std::size_t offset(const yaml_mark_t& found) const {
        std::size_t at = lines_[found.line];
        const auto continues = [](char c) {
            return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
        };
        for (std::size_t left = found.column; left > 0 && at < text_.size(); --left)
            do
                ++at;
            while (at < text_.size() && continues(text_[at]));
        return at;
    }

    std::string_view text_;
    const std::string& where_;
    std::vector<std::size_t> lines_;  ///< where each begins; of a text beyond ASCII alone
};

/// libyaml's parser over one text, and the event that it came to last.
class Events {
  public:
    Events(std::string_view text, const Places& places) : places_(places) {
        if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
        yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                     text.size());
    }
    ~Events() {
        yaml_event_delete(&event_);
        yaml_parser_delete(&parser_);
    }
    Events(const Events&) = delete;
    Events& operator=(const Events&) = delete;

    const yaml_event_t& next() {
        yaml_event_delete(&event_);
        if (yaml_parser_parse(&parser_, &event_) == 0) refuse();
        return event_;
    }

  private:
    [[noreturn]] void refuse() const {
        if (parser_.error == YAML_MEMORY_ERROR) throw std::bad_alloc();
        const std::string_view problem = parser_.problem ? parser_.problem : "it cannot be read";
        const std::string_view context = parser_.context ? parser_.context : "";
        const char* const remedy = "Check indentation, colons and quotes there";
        if (context.find("quoted scalar") != std::string_view::npos &&
            (problem == "found unexpected end of stream" ||
             problem == "found unexpected document indicator"))
            places_.refuse(places_.mark(parser_.context_mark),
                           "not valid YAML: a quote is not closed", remedy);
        places_.refuse(
            places_.mark(parser_.problem_mark),
            fmt::format("not valid YAML: {}{}{}", context, context.empty() ? "" : ", ", problem),
            remedy);
    }

    const Places& places_;
    yaml_parser_t parser_{};
    yaml_event_t event_{};
};

/// Builds a document from its events, and refuses what would make it large or ambiguous.
class StrictDocument {
  public:
    explicit StrictDocument(const Places& places) : places_(places) {}

    void take(const yaml_event_t& event) {
        switch (event.type) {
            case YAML_DOCUMENT_START_EVENT:
                if (++documents_ > 1)
                    refuse(event, "the file holds more than one YAML document",
                           "Keep one, without further `---` lines, and check the indentation "
                           "there");
                break;
            case YAML_SCALAR_EVENT:
                take_scalar(event);
                break;
            case YAML_SEQUENCE_START_EVENT:
                begin(YamlKind::list, event, event.data.sequence_start.anchor,
                      text_of(event.data.sequence_start.tag));
                break;
            case YAML_MAPPING_START_EVENT:
                begin(YamlKind::map, event, event.data.mapping_start.anchor,
                      text_of(event.data.mapping_start.tag));
                break;
            case YAML_SEQUENCE_END_EVENT:
            case YAML_MAPPING_END_EVENT:
                if (const auto key = builder_.end())
                    places_.refuse(
                        key->mark,
                        "the key \"" + escape_for_message(key->text) + "\" stands twice in one map",
                        "Keep one of the two");
                break;
            case YAML_ALIAS_EVENT:
                refuse_alias(event);
            default:
                break;
        }
    }

    /// A null node where there is none.
    YamlNode document() && { return builder_.is_empty() ? YamlNode() : std::move(builder_).take(); }

  private:
    [[noreturn]] void refuse(const yaml_event_t& event, const std::string& what,
                             const std::string& remedy) const {
        places_.refuse(places_.mark(event.start_mark), what, remedy);
    }
    [[noreturn]] void refuse_alias(const yaml_event_t& event) const {
        refuse(event, "YAML anchors and aliases are not read", "Write the value out in each place");
    }

    /// A tag that says what its value already is would need a check of its own: only those that
    /// astropy writes are read, and the one of text without a tag.
    void check(const yaml_event_t& event, const yaml_char_t* anchor, std::string_view tag) const {
        if (anchor) refuse_alias(event);
        constexpr std::string_view standard = "tag:yaml.org,2002:";
        const std::string_view kind = tag.starts_with(standard) ? tag.substr(standard.size()) : "";
        if (!tag.empty() && tag != "!" && kind != "map" && kind != "seq" && kind != "omap")
            refuse(event, "the tag \"" + escape_for_message(tag) + "\" is not understood",
                   "Remove it");
    }
    [[noreturn]] void refuse_key(const yaml_event_t& event) const {
        refuse(event, "a key is not text", "Write one word as the key");
    }

    void take_scalar(const yaml_event_t& event) {
        const auto& scalar = event.data.scalar;
        const std::string_view tag = text_of(scalar.tag);
        check(event, scalar.anchor, tag);
        const std::string_view text(reinterpret_cast<const char*>(scalar.value), scalar.length);
        const bool is_quoted = scalar.style != YAML_PLAIN_SCALAR_STYLE || tag == "!";
        const YamlMark mark = places_.mark(event.start_mark);
        if (is_quoted || !is_null_word(text)) return builder_.scalar(text, is_quoted, mark);
        if (builder_.is_at_key()) refuse_key(event);
        builder_.null(mark);
    }

    void begin(YamlKind kind, const yaml_event_t& event, const yaml_char_t* anchor,
               std::string_view tag) {
        constexpr std::size_t deepest = 32;
        if (builder_.is_at_key()) refuse_key(event);
        check(event, anchor, tag);
        if (builder_.depth() == deepest)
            refuse(event, "the document is nested deeper than 32 levels",
                   "No file of this program is; check what this file is");
        builder_.begin(kind, places_.mark(event.start_mark), tag == "tag:yaml.org,2002:omap");
    }

    const Places& places_;
    int documents_ = 0;
    YamlBuilder builder_;
};

}  // namespace

YamlNode parse_yaml(std::string_view text, const std::string& where) {
    refuse_other_encodings(text, where);
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    refuse_unprintable_lines(text, where);
    const Places places(text, where);
    Events events(text, places);
    StrictDocument document(places);
    for (bool more = true; more;) {
        const yaml_event_t& event = events.next();
        more = event.type != YAML_STREAM_END_EVENT;
        document.take(event);
    }
    YamlNode root = std::move(document).document();
    if (root.is_null()) throw Failure(where, "the file is empty", "Give the file its content back");
    return root;
}

}  // namespace runcert
