#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace runcert {

/// What some programs write in front of UTF-8 text.
inline constexpr std::string_view utf8_mark = "\xef\xbb\xbf";

enum class YamlKind : std::uint8_t { null, scalar, list, map };

/// Where a node begins: line and column of its first byte, from 0; -1 for a node without a place.
struct YamlMark {
    std::int32_t line = -1;
    std::int32_t column = -1;
};

/// One node as it is stored: of numbers alone, so that the documents that are compiled into the
/// program need neither memory nor relocation when it starts.
struct YamlEntry {
    YamlMark mark{};
    std::uint32_t begin = 0;  ///< a scalar's text, in bytes of the document's texts; else its first
                              ///< child, in entries
    std::uint32_t count = 0;  ///< bytes of a scalar; items of a list; of a map, keys and values
    YamlKind kind = YamlKind::null;
    bool is_quoted = false;
    bool is_ordered_map = false;  ///< a list that has the tag !!omap
};

/// The nodes of one document. The children of a node stand together, a map's as key, value, key,
/// value; the root stands last.
struct YamlDocument {
    std::span<const YamlEntry> entries;
    std::string_view texts;
};

/// A node of a YAML document. Copies are cheap; the document lives as long as any of its nodes.
class YamlNode {
  public:
    /// No node: what a map has under a name that it does not hold.
    YamlNode() = default;
    /// The root of a document that outlives the program's use of it: one compiled in.
    explicit YamlNode(const YamlDocument& fixed);
    /// The root of a document.
    explicit YamlNode(std::shared_ptr<const YamlDocument> document);

    bool is_defined() const { return entry_ != nullptr; }
    bool is_null() const { return kind() == YamlKind::null; }
    bool is_scalar() const { return kind() == YamlKind::scalar; }
    bool is_list() const { return kind() == YamlKind::list; }
    bool is_map() const { return kind() == YamlKind::map; }
    YamlKind kind() const { return entry_ ? entry_->kind : YamlKind::null; }
    /// Whether a scalar is text whatever it looks like: quoted, or a block of lines.
    bool is_quoted() const { return entry_ && entry_->is_quoted; }
    /// Whether a list has the tag !!omap.
    bool is_ordered_map() const { return entry_ && entry_->is_ordered_map; }
    YamlMark mark() const { return entry_ ? entry_->mark : YamlMark{}; }

    /// The text of a scalar, without quotes; empty for any other node.
    std::string_view scalar() const;
    /// Items of a list, pairs of a map; else 0.
    std::size_t size() const;
    /// The item of a list, which has it.
    YamlNode item(std::size_t index) const { return child(index); }
    /// Key and value of a pair of a map, which has it.
    YamlNode key(std::size_t index) const { return child(2 * index); }
    YamlNode value(std::size_t index) const { return child(2 * index + 1); }
    /// The value of that key of a map; no node where there is none.
    YamlNode operator[](std::string_view name) const;
    /// The item of a list; no node where there is none.
    YamlNode operator[](std::size_t index) const;

  private:
    YamlNode child(std::size_t index) const;

    std::shared_ptr<const YamlDocument> document_;
    const YamlEntry* entry_ = nullptr;
};

/// A key of a map, and where it stands.
struct YamlKey {
    std::string text;
    YamlMark mark;
};

/// Makes a document of its nodes in the order of the text: a map's keys and values in turn.
class YamlBuilder {
  public:
    void null(YamlMark mark);
    void scalar(std::string_view text, bool is_quoted, YamlMark mark);
    void begin(YamlKind list_or_map, YamlMark mark, bool is_ordered_map = false);
    /// Ends the list or map begun last. Where it is a map that holds two equal keys, the second.
    std::optional<YamlKey> end();
    /// A node of another document, with all below it; where a mark is given, with that place.
    void copy(const YamlNode& node, std::optional<YamlMark> place = std::nullopt);

    /// Lists and maps that are begun and not ended.
    std::size_t depth() const { return levels_.size(); }
    /// Whether what comes next is the key of a map.
    bool is_at_key() const;
    /// Whether there is no node yet.
    bool is_empty() const { return pending_.empty() && levels_.empty(); }

    /// The root, where everything has been ended.
    YamlNode take() &&;
    /// What a generator of sources needs of it, where everything has been ended.
    std::vector<YamlEntry> entries() const;
    const std::string& texts() const { return texts_; }

  private:
    struct Level {
        YamlEntry container;
        std::size_t first_child;  ///< in `pending_`
    };
    std::optional<YamlKey> repeated_key(std::span<const YamlEntry> pairs) const;

    std::vector<Level> levels_;
    std::vector<YamlEntry> pending_;  ///< children, complete, of what is not ended
    std::vector<YamlEntry> entries_;
    std::string texts_;
};

}  // namespace runcert
