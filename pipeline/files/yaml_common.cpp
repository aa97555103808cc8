#include <yaml.h>

#include <algorithm>

#include "files/yaml_parsers.h"

namespace runcert {
namespace {

bool is_ascii(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// Tabs, which libyaml takes for blanks in other places, a mark of the encoding, and a carriage
/// return that no line feed follows, which libyaml takes for the end of a line.
bool holds_what_they_see_differently(std::string_view text) {
    if (text.find('\t') != std::string_view::npos || text.starts_with("\xef\xbb\xbf")) return true;
    for (std::size_t at = 0; (at = text.find('\r', at)) != std::string_view::npos; ++at)
        if (!text.substr(at + 1).starts_with('\n')) return true;
    return false;
}

bool is_null_word(std::string_view text) {
    return text == "~" || text == "null" || text == "Null" || text == "NULL";
}

std::ptrdiff_t question_marks_in(std::string_view text) {
    return std::ranges::count(text, '?');
}

/// libyaml's parser over one text, and the event that it came to last.
class Events {
  public:
    explicit Events(std::string_view text) {
        is_made_ = yaml_parser_initialize(&parser_) != 0;
        if (is_made_)
            yaml_parser_set_input_string(
                &parser_, reinterpret_cast<const unsigned char*>(text.data()), text.size());
    }
    ~Events() {
        forget();
        if (is_made_) yaml_parser_delete(&parser_);
    }
    Events(const Events&) = delete;
    Events& operator=(const Events&) = delete;

    /// The next event; null where the text is none that it reads.
    const yaml_event_t* next() {
        forget();
        if (!is_made_ || yaml_parser_parse(&parser_, &event_) == 0) return nullptr;
        has_event_ = true;
        return &event_;
    }

  private:
    void forget() {
        if (has_event_) yaml_event_delete(&event_);
        has_event_ = false;
    }

    yaml_parser_t parser_{};
    yaml_event_t event_{};
    bool is_made_ = false;
    bool has_event_ = false;
};

/// Places in bytes, as yaml-cpp counts them; libyaml counts characters.
class Places {
  public:
    explicit Places(std::string_view text) : text_(text) {
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

    char character(const yaml_mark_t& found) const {
        const std::size_t at = found.line < lines_.size() ? offset(found) : found.index;
        return at < text_.size() ? text_[at] : '\0';
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
    std::vector<std::size_t> lines_;  ///< where each begins; of a text beyond ASCII alone
};

/// Builds a document from libyaml's events. Each function says whether both parsers are known to
/// see the same.
class CommonDocument {
  public:
    explicit CommonDocument(std::string_view text) : text_(text), places_(text) {}

    bool take(const yaml_event_t& event) {
        switch (event.type) {
            case YAML_DOCUMENT_START_EVENT:
                return ++documents_ == 1 && !event.data.document_start.version_directive &&
                       event.data.document_start.tag_directives.start ==
                           event.data.document_start.tag_directives.end;
            case YAML_SCALAR_EVENT:
                return take_scalar(event);
            case YAML_SEQUENCE_START_EVENT:
                return !event.data.sequence_start.anchor && !event.data.sequence_start.tag &&
                       begin(YamlKind::list, event);
            case YAML_MAPPING_START_EVENT:
                return !event.data.mapping_start.anchor && !event.data.mapping_start.tag &&
                       !is_single_pair(event) && begin(YamlKind::map, event);
            case YAML_SEQUENCE_END_EVENT:
            case YAML_MAPPING_END_EVENT:
                return builder_.end();
            case YAML_ALIAS_EVENT:
                return false;
            default:
                return true;
        }
    }

    std::optional<YamlNode> document() && {
        // Elsewhere than in quotes one may be the mark of a key, and yaml-cpp takes it for that in
        // the midst of a word too, between braces.
        if (question_marks_ != question_marks_in(text_)) return std::nullopt;
        if (builder_.is_empty()) return std::nullopt;
        YamlNode root = std::move(builder_).take();
        if (root.is_null()) return std::nullopt;
        return root;
    }

  private:
    bool take_scalar(const yaml_event_t& event) {
        const auto& scalar = event.data.scalar;
        if (scalar.anchor || scalar.tag || event.start_mark.line != event.end_mark.line)
            return false;
        const bool is_plain = scalar.style == YAML_PLAIN_SCALAR_STYLE;
        if (!is_plain && scalar.style != YAML_SINGLE_QUOTED_SCALAR_STYLE &&
            scalar.style != YAML_DOUBLE_QUOTED_SCALAR_STYLE)
            return false;
        const std::string_view text(reinterpret_cast<const char*>(scalar.value), scalar.length);
        const YamlMark mark = places_.mark(event.start_mark);
        if (is_plain && text.empty()) return false;
        if (is_plain && is_null_word(text)) {
            if (builder_.is_at_key()) return false;
            builder_.null(mark);
        } else {
            if (!is_plain) question_marks_ += question_marks_in(text);
            builder_.scalar(text, !is_plain, mark);
        }
        return true;
    }

    bool begin(YamlKind kind, const yaml_event_t& event) {
        constexpr std::size_t deepest = 32;
        if (builder_.is_at_key() || builder_.depth() == deepest) return false;
        builder_.begin(kind, places_.mark(event.start_mark));
        return true;
    }

    /// A map of one pair without braces, inside a list: `[a: 1]`.
    bool is_single_pair(const yaml_event_t& event) const {
        return event.data.mapping_start.style == YAML_FLOW_MAPPING_STYLE &&
               places_.character(event.start_mark) != '{';
    }

    std::string_view text_;
    Places places_;
    std::ptrdiff_t question_marks_ = 0;  ///< in quotes
    YamlBuilder builder_;
    int documents_ = 0;
};

}  // namespace

std::optional<YamlNode> parse_common_yaml(std::string_view text) {
    if (holds_what_they_see_differently(text)) return std::nullopt;
    Events events(text);
    CommonDocument document(text);
    for (;;) {
        const yaml_event_t* event = events.next();
        if (!event || !document.take(*event)) return std::nullopt;
        if (event->type == YAML_STREAM_END_EVENT) return std::move(document).document();
    }
}

}  // namespace runcert
