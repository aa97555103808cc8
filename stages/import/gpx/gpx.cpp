#include "stages/import/gpx/gpx.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/format.h"
#include "stages/import/gpx/point.h"

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

/// Finds the tags of an XML text, whatever else is in it: comments, CDATA, processing instructions
/// and the document type, entities included, are passed over unread. It goes through the text
/// once and keeps nothing; it does not check that elements are closed.
class TagScanner {
  public:
    explicit TagScanner(std::string_view text) : text_(text) {}

    /// The next tag; nothing at the end.
    std::optional<Tag> next() {
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

  private:
    void pass_over_declaration() {
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

    /// Of "<!DOCTYPE ... [ ... ] ... >": quoted texts, comments and instructions in it may hold any
    /// of these marks.
    std::size_t end_of_document_type() const {
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

    Tag read_tag() const {
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

    std::string_view text_;
    std::size_t at_ = 0;
};

/// Lines of a text, counted as far as was asked for.
class LineCounter {
  public:
    explicit LineCounter(std::string_view text) : text_(text) {}

    /// Where the byte at `offset` stands; offsets do not go back.
    Piece place(std::size_t offset) {
        const std::string_view passed = text_.substr(at_, offset - at_);
        line_ += std::count(passed.begin(), passed.end(), '\n');
        if (const std::size_t last = passed.rfind('\n'); last != std::string_view::npos)
            line_start_ = at_ + last + 1;
        at_ = offset;
        const SourceLine source{
            .text = {}, .number = line_, .byte = static_cast<std::int64_t>(offset)};
        return {.text = {}, .place = source, .column = offset - line_start_ + 1};
    }

  private:
    std::string_view text_;
    std::size_t at_ = 0;
    std::size_t line_start_ = 0;
    std::int64_t line_ = 1;
};

/// Reads a recording tag by tag.
class GpxReader {
  public:
    explicit GpxReader(const RecordingBytes& recording)
        : recording_(recording), lines_(recording.bytes), timed_(recording), points_(recording) {}

    Observations read() {
        TagScanner tags(recording_.bytes);
        while (const auto tag = tags.next())
            read_tag(*tag);
        if (open_) lose_point("the track point is cut off by the end of the file");
        refuse_without_points();
        Observations observations;
        observations.time_scale = "utc";  // set_rows asks for it
        observations.device = device_;
        observations.variant = version_.empty() ? "GPX" : "GPX " + version_;
        set_rows(observations, std::move(timed_));
        note_content(observations);
        return observations;
    }

  private:
    void read_tag(const Tag& tag) {
        if (tag.name == "trkpt")
            read_point_tag(tag);
        else if (tag.name == "gpx" && tag.kind == Tag::Kind::end)
            ended_ = true;
        else if (tag.name == "gpx" && tag.kind == Tag::Kind::start && version_.empty())
            read_root(tag);
        else if (tag.kind != Tag::Kind::end && (tag.name == "rtept" || tag.name == "wpt"))
            ++other_points_;
    }

    void read_point_tag(const Tag& tag) {
        if (tag.closing) {
            if (open_ && tag.kind == Tag::Kind::end) read_point(tag.end);
            if (open_) lose_point("the track point's end tag is broken");
            return;
        }
        if (open_) lose_point("the track point has no end tag before the next one begins");
        open_ = lines_.place(tag.begin);
        if (tag.kind == Tag::Kind::empty) read_point(tag.end);
        if (tag.kind == Tag::Kind::broken) lose_point("the track point's tag is broken");
    }

    void read_point(std::size_t end) {
        Piece piece = *open_;
        open_.reset();
        const auto begin = static_cast<std::size_t>(piece.place.byte);
        piece.text = recording_.bytes.substr(begin, end - begin);
        timed_.add_record(piece.place, [&] { return points_.read(piece); });
    }

    void lose_point(std::string_view why) {
        const Piece piece = *open_;
        open_.reset();
        timed_.count_bad(piece.place,
                         Failure(place_in(recording_, *piece.place.line, piece.column),
                                 std::string(why), "Take the recording as the receiver wrote it"));
    }

    void read_root(const Tag& tag) {
        std::string text(recording_.bytes.substr(
            tag.begin, std::min(tag.end - tag.begin, PointReader::longest_piece)));
        if (text.ends_with('>')) text.insert(text.size() - 1, 1, '/');
        pugi::xml_document document;
        if (!document.load_buffer(text.data(), text.size(), pugi::parse_default,
                                  pugi::encoding_utf8))
            return;
        const pugi::xml_node root = document.first_child();
        version_ = escape_for_message(trim(root.attribute("version").value()));
        device_ = escape_for_message(trim(root.attribute("creator").value()), 80);
    }

    void refuse_without_points() const {
        const std::int64_t points = timed_.records().total;
        if (points == 0)
            throw Failure(place_in(recording_, 1, 1),
                          other_points_ == 0
                              ? std::string("the GPX holds no track point (trkpt)")
                              : fmt::format("the GPX holds no track point (trkpt), but {} points "
                                            "of routes or places, which nobody drove along",
                                            other_points_),
                          "Export the recorded track");
        if (static_cast<std::int64_t>(points_.counts().without_time) == points)
            throw Failure(place_in(recording_, 1, 1),
                          fmt::format("none of the {} track points has a time, and a track "
                                      "without times cannot show a speed",
                                      points),
                          "Export the track with its times");
    }

    void note_content(Observations& observations) const {
        std::vector<std::string>& notes = observations.notes;
        const PointCounts& counts = points_.counts();
        if (counts.without_zone > 0)
            notes.push_back(
                fmt::format("{} times do not say in which zone they are, and were taken as UTC.",
                            counts.without_zone));
        if (std::any_of(observations.rows.begin(), observations.rows.end(),
                        [](const Observation& row) { return row.height_m.has_value(); }))
            notes.push_back(
                "A GPX does not say what its heights are above, mean sea level by its schema; they "
                "were taken as above the ellipsoid.");
        if (!ended_) notes.push_back("The file ends before its </gpx>: it may have been cut off.");
    }

    const RecordingBytes& recording_;
    LineCounter lines_;
    RowCollector timed_;
    PointReader points_;
    std::optional<Piece> open_;  ///< the point whose start tag was read, without text yet
    std::string version_;
    std::string device_;
    std::size_t other_points_ = 0;
    bool ended_ = false;
};

bool recognises(std::string_view bytes) {
    const auto root = root_tag(bytes);
    return root && root->name == "gpx" &&
           (root->kind == Tag::Kind::start || root->kind == Tag::Kind::empty);
}

}  // namespace

std::optional<Tag> root_tag(std::string_view bytes) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (bytes.starts_with(byte_order_mark)) bytes.remove_prefix(byte_order_mark.size());
    if (!trim(bytes.substr(0, 1024)).starts_with('<')) return std::nullopt;
    return TagScanner(bytes).next();
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    Observations observations = GpxReader(recording).read();
    observations.format = "gpx";
    observations.frame = "geodetic";
    apply_attempt(observations, receiver);
    return observations;
}

extern const Format format{
    .name = "gpx",
    .what = "GPX",
    .place = 80,
    .time_origin = "times of the file's points, whose clock the format does not say",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::gpx
