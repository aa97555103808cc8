#include "store/yaml_node.h"

#include <algorithm>
#include <utility>

namespace runcert {
namespace {

/// A document that owns what it consists of.
struct OwnedDocument : YamlDocument {
    OwnedDocument(std::vector<YamlEntry> all, std::string text)
        : own_entries(std::move(all)), own_texts(std::move(text)) {
        entries = own_entries;
        texts = own_texts;
    }
    std::vector<YamlEntry> own_entries;
    std::string own_texts;
};

std::string_view text_of(const YamlEntry& scalar, std::string_view texts) {
    return texts.substr(scalar.begin, scalar.count);
}

}  // namespace

YamlNode::YamlNode(const YamlDocument& fixed)
    // Shares ownership with nothing: copies count no references.
    : document_(std::shared_ptr<const YamlDocument>(), &fixed), entry_(&fixed.entries.back()) {}

YamlNode::YamlNode(std::shared_ptr<const YamlDocument> document)
    : document_(std::move(document)), entry_(&document_->entries.back()) {}

std::string_view YamlNode::scalar() const {
    return is_scalar() ? text_of(*entry_, document_->texts) : std::string_view();
}

std::size_t YamlNode::size() const {
    if (is_list()) return entry_->count;
    return is_map() ? entry_->count / 2 : 0;
}

YamlNode YamlNode::child(std::size_t index) const {
    YamlNode node = *this;
    node.entry_ = &document_->entries[entry_->begin + index];
    return node;
}

YamlNode YamlNode::operator[](std::string_view name) const {
    if (!is_map()) return {};
    const std::span<const YamlEntry> pairs =
        document_->entries.subspan(entry_->begin, entry_->count);
    for (std::size_t i = 0; i < pairs.size(); i += 2)
        if (pairs[i].count == name.size() && text_of(pairs[i], document_->texts) == name)
            return child(i + 1);
    return {};
}

YamlNode YamlNode::operator[](std::size_t index) const {
    return is_list() && index < size() ? child(index) : YamlNode();
}

void YamlBuilder::null(YamlMark mark) {
    pending_.push_back({.mark = mark});
}

void YamlBuilder::scalar(std::string_view text, bool is_quoted, YamlMark mark) {
    pending_.push_back({.mark = mark,
                        .begin = static_cast<std::uint32_t>(texts_.size()),
                        .count = static_cast<std::uint32_t>(text.size()),
                        .kind = YamlKind::scalar,
                        .is_quoted = is_quoted});
    texts_ += text;
}

void YamlBuilder::begin(YamlKind list_or_map, YamlMark mark, bool is_ordered_map) {
    levels_.push_back(
        {{.mark = mark, .kind = list_or_map, .is_ordered_map = is_ordered_map}, pending_.size()});
}

std::optional<YamlKey> YamlBuilder::repeated_key(std::span<const YamlEntry> pairs) const {
    const auto key = [&](std::size_t i) { return text_of(pairs[i], texts_); };
    std::vector<std::size_t> keys(pairs.size() / 2);
    for (std::size_t i = 0; i < keys.size(); ++i)
        keys[i] = 2 * i;
    std::ranges::stable_sort(keys, {}, key);
    const auto first = std::ranges::adjacent_find(keys, {}, key);
    if (first == keys.end()) return std::nullopt;
    const std::size_t second = *std::next(first);
    return YamlKey{std::string(key(second)), pairs[second].mark};
}

std::optional<YamlKey> YamlBuilder::end() {
    Level level = levels_.back();
    levels_.pop_back();
    const auto children = std::span<const YamlEntry>(pending_).subspan(level.first_child);
    std::optional<YamlKey> repeated;
    if (level.container.kind == YamlKind::map) repeated = repeated_key(children);
    level.container.begin = static_cast<std::uint32_t>(entries_.size());
    level.container.count = static_cast<std::uint32_t>(children.size());
    entries_.insert(entries_.end(), children.begin(), children.end());
    pending_.resize(level.first_child);
    pending_.push_back(level.container);
    return repeated;
}

void YamlBuilder::copy(const YamlNode& node, std::optional<YamlMark> place) {
    const YamlMark mark = place.value_or(node.mark());
    if (node.is_null()) return null(mark);
    if (node.is_scalar()) return scalar(node.scalar(), node.is_quoted(), mark);
    begin(node.kind(), mark, node.is_ordered_map());
    for (std::size_t i = 0; i < node.size(); ++i) {
        if (node.is_map()) copy(node.key(i), place);
        copy(node.is_map() ? node.value(i) : node.item(i), place);
    }
    end();
}

bool YamlBuilder::is_at_key() const {
    if (levels_.empty() || levels_.back().container.kind != YamlKind::map) return false;
    return (pending_.size() - levels_.back().first_child) % 2 == 0;
}

std::vector<YamlEntry> YamlBuilder::entries() const {
    std::vector<YamlEntry> all = entries_;
    all.push_back(pending_.front());
    return all;
}

YamlNode YamlBuilder::take() && {
    entries_.push_back(pending_.front());
    return YamlNode(std::make_shared<const OwnedDocument>(std::move(entries_), std::move(texts_)));
}

}  // namespace runcert
