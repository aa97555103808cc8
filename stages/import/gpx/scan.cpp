#include "stages/import/gpx/scan.h"

#include <algorithm>

namespace runcert::gpx {
namespace {

constexpr std::size_t none = std::string_view::npos;

/// The offset behind the next `mark`, or the end.
std::size_t behind(std::string_view text, std::string_view mark, std::size_t from) {
    const std::size_t at = text.find(mark, std::min(from, text.size()));
    return at == none ? text.size() : at + mark.size();
}

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

}  // namespace

/// Of "<!DOCTYPE ... [ ... ] ... >": quoted texts, comments and instructions in it may hold any of
/// these marks.
std::size_t TagScanner::end_of_document_type() const {
    bool inside = false;
    std::size_t at = at_ + 2;
    while (at < text_.size()) {
        const char c = text_[at];
        const std::string_view here = text_.substr(at, 4);
        if (c == '"' || c == '\'') {
            at = behind(text_, text_.substr(at, 1), at + 1);
        } else if (here == "<!--") {
            at = behind(text_, "-->", at + 4);
        } else if (here.starts_with("<?")) {
            at = behind(text_, "?>", at + 2);
        } else {
            if (c == '[') inside = true;
            if (c == ']') inside = false;
            ++at;
            if (c == '>' && !inside) return at;
        }
    }
    return text_.size();
}

void TagScanner::pass_over_declaration() {
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("<!--"))
        at_ = behind(text_, "-->", at_ + 4);
    else if (rest.starts_with("<![CDATA["))
        at_ = behind(text_, "]]>", at_ + 9);
    else if (rest.starts_with("<?"))
        at_ = behind(text_, "?>", at_ + 2);
    else
        at_ = end_of_document_type();
}

Tag TagScanner::read_tag() const {
    const bool closing = text_.substr(at_ + 1, 1) == "/";
    Tag tag{.kind = Tag::Kind::broken,
            .closing = closing,
            .name = {},
            .begin = at_,
            .end = text_.size()};
    const std::size_t name_at = at_ + (closing ? 2 : 1);
    std::size_t at = name_at;
    while (at < text_.size() && !is_blank(text_[at]) && text_[at] != '>' && text_[at] != '/' &&
           text_[at] != '<')
        ++at;
    tag.name = text_.substr(std::min(name_at, text_.size()), at - name_at);
    if (const std::size_t colon = tag.name.find(':'); colon != none)
        tag.name.remove_prefix(colon + 1);
    while (at < text_.size()) {
        const char c = text_[at];
        if (c == '>') {
            tag.end = at + 1;
            tag.kind = closing ? Tag::Kind::end
                               : (text_[at - 1] == '/' ? Tag::Kind::empty : Tag::Kind::start);
            return tag;
        }
        if (c == '<') break;
        if (c == '"' || c == '\'') {
            // No '<' stands in an attribute's value: one that is never closed ends there.
            at = text_.find_first_of(c == '"' ? "\"<" : "'<", at + 1);
            if (at == none || text_[at] == '<') break;
        }
        ++at;
    }
    tag.end = std::min(at, text_.size());
    return tag;
}

std::optional<Tag> TagScanner::next() {
    for (;;) {
        at_ = text_.find('<', at_);
        if (at_ == none) {
            at_ = text_.size();
            return std::nullopt;
        }
        const char second = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
        if (second == '!' || second == '?') {
            pass_over_declaration();
            continue;
        }
        const Tag tag = read_tag();
        at_ = std::max(tag.end, at_ + 1);
        return tag;
    }
}

}  // namespace runcert::gpx
