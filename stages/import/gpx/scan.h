#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace runcert::gpx {

/// A tag of an XML text.
struct Tag {
    enum class Kind { start, end, empty, broken };
    Kind kind = Kind::start;
    bool closing = false;   ///< whether it begins with "</"
    std::string_view name;  ///< without its namespace prefix
    std::size_t begin = 0;  ///< offset of its '<'
    std::size_t end = 0;    ///< offset behind its '>'; of a broken one, where to read on
};

/// Finds the tags of an XML text, whatever else is in it: comments, CDATA, processing instructions
/// and the document type, entities included, are passed over unread. It goes through the text
/// once and keeps nothing; it does not check that elements are closed.
class TagScanner {
  public:
    explicit TagScanner(std::string_view text) : text_(text) {}

    /// The next tag; nothing at the end.
    std::optional<Tag> next();

  private:
    void pass_over_declaration();
    std::size_t end_of_document_type() const;
    Tag read_tag() const;

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace runcert::gpx
