#include "files/yaml_input.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "core/failure.h"
#include "core/text.h"
#include "files/signature_text.h"

namespace runcert {
namespace {

std::string place(const std::string& where, const YAML::Mark& mark) {
    if (mark.is_null()) return where;
    return fmt::format("{}:{}:{}", where, mark.line + 1, mark.column + 1);
}

/// Looks at a document's events before a tree is built from them, so that what would make the
/// tree large or ambiguous is refused first.
class StrictEvents : public YAML::EventHandler {
  public:
    explicit StrictEvents(const std::string& where) : where_(where) {}

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (++documents_ > 1)
            throw Failure(place(where_, mark), "the file holds more than one YAML document",
                          "Keep one, without further `---` lines, and check the indentation there");
    }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        refuse_as_key(mark);
        enter(mark, "", anchor, "");
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_alias(mark); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        enter(mark, tag, anchor, value);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        refuse_as_key(mark);
        enter(mark, tag, anchor, "");
        push(mark, false);
    }
    void OnSequenceEnd() override { levels_.pop_back(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        refuse_as_key(mark);
        enter(mark, tag, anchor, "");
        push(mark, true);
    }
    void OnMapEnd() override { levels_.pop_back(); }

  private:
    struct Level {
        bool is_map;
        bool key_next = true;
        std::set<std::string> keys{};
    };

    void enter(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
               const std::string& value) {
        if (anchor != 0) refuse_alias(mark);
        if (!is_understood(tag))
            throw Failure(place(where_, mark),
                          "the tag \"" + escape_for_message(tag) + "\" is not understood",
                          "Remove it");
        if (levels_.empty() || !levels_.back().is_map) return;
        Level& level = levels_.back();
        if (level.key_next && !level.keys.insert(value).second)
            throw Failure(place(where_, mark),
                          "the key \"" + escape_for_message(value) + "\" stands twice in one map",
                          "Keep one of the two");
        level.key_next = !level.key_next;
    }
    void push(const YAML::Mark& mark, bool is_map) {
        if (levels_.size() == 32)
            throw Failure(place(where_, mark), "the document is nested deeper than 32 levels",
                          "No file of this program is; check what this file is");
        levels_.push_back({is_map});
    }
    /// "?" and "!" stand for plain and for quoted text without a tag. A tag that says what its
    /// value already is would need a check of its own: only those that astropy writes are read.
    static bool is_understood(std::string_view tag) {
        if (tag.empty() || tag == "?" || tag == "!") return true;
        constexpr std::string_view standard = "tag:yaml.org,2002:";
        if (!tag.starts_with(standard)) return false;
        tag.remove_prefix(standard.size());
        return tag == "map" || tag == "seq" || tag == "omap";
    }
    void refuse_as_key(const YAML::Mark& mark) const {
        if (!levels_.empty() && levels_.back().is_map && levels_.back().key_next)
            throw Failure(place(where_, mark), "a key is not text", "Write one word as the key");
    }
    [[noreturn]] void refuse_alias(const YAML::Mark& mark) {
        throw Failure(place(where_, mark), "YAML anchors and aliases are not read",
                      "Write the value out in each place");
    }

    const std::string& where_;
    int documents_ = 0;
    std::vector<Level> levels_;
};

void refuse_other_encodings(std::string_view text, const std::string& where) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        throw Failure(where, "the file is UTF-16 text", "Save it as UTF-8");
    const std::size_t nul = text.find('\0');
    if (nul != std::string_view::npos)
        throw Failure(where, fmt::format("byte {} is zero: this is not a text file", nul),
                      "Save it as UTF-8 text");
}

/// yaml-cpp passes malformed UTF-8 through, and takes the control character 4 for the end of the
/// file and a lone carriage return for a line's.
void refuse_unprintable_lines(std::string_view text, const std::string& where) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view content = text.substr(0, end);
        if (content.ends_with('\r')) content.remove_suffix(1);
        if (!signature_text::is_printable_line(content))
            throw Failure(fmt::format("{}:{}:1", where, line),
                          "the line holds control characters, or bytes that are not UTF-8",
                          "Save the file as UTF-8 text, and write such characters as escapes "
                          "(\"\\u200f\")");
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

}  // namespace

YAML::Node parse_yaml(std::string_view text, const std::string& where) {
    refuse_other_encodings(text, where);
    refuse_unprintable_lines(text, where);
    // yaml-cpp takes a quote that is never closed for closed at the end of the file, unless a mark
    // of the document's end stands there.
    std::string marked(text);
    marked += text.ends_with('\n') ? "...\n" : "\n...\n";
    try {
        std::istringstream stream(marked);
        YAML::Parser parser(stream);
        StrictEvents events(where);
        while (parser.HandleNextDocument(events)) {
        }
        YAML::Node document = YAML::Load(marked);
        if (document.IsNull())
            throw Failure(where, "the file is empty", "Give the file its content back");
        return document;
    } catch (const YAML::Exception& error) {
        const bool unclosed = error.msg == YAML::ErrorMsg::DOC_IN_SCALAR;
        throw Failure(place(where, error.mark),
                      "not valid YAML: " + (unclosed ? "a quote is not closed" : error.msg),
                      "Check indentation, colons and quotes there");
    }
}

std::string yaml_place(const std::string& where, const YAML::Node& node) {
    if (!node.IsDefined()) return where;
    return place(where, node.Mark());
}

YamlValue::YamlValue(const YAML::Node& node, std::string where, std::string path)
    : node_(node), where_(std::move(where)), path_(std::move(path)) {}

YamlValue& YamlValue::operator=(const YamlValue& other) {
    // Assignment of a YAML::Node would write into the tree that both belong to.
    node_.reset(other.node_);
    where_ = other.where_;
    path_ = other.path_;
    return *this;
}

void YamlValue::fail(const std::string& what, const std::string& remedy) const {
    throw Failure(place(), path_.empty() ? what : path_ + ": " + what, remedy);
}

YamlValue YamlValue::operator[](const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    const YAML::Node& map = node_;
    if (is_map() && map[key].IsDefined()) return {map[key], where_, path};
    return {YAML::Node(YAML::NodeType::Undefined), where_, path};
}

bool YamlValue::exists() const {
    return node_.IsDefined() && !node_.IsNull();
}

const std::string& YamlValue::scalar(const char* expected) const {
    if (!exists()) fail("is missing", fmt::format("Give {}", expected));
    if (!node_.IsScalar())
        fail(fmt::format("is a {}, not {}", node_.IsMap() ? "map" : "list", expected),
             fmt::format("Give {}", expected));
    return node_.Scalar();
}

std::string YamlValue::text() const {
    return scalar("text");
}

double YamlValue::real() const {
    const std::string& value = scalar("a number");
    const auto number = parse_double(value);
    if (node_.Tag() == "!" || !number)
        fail(fmt::format("\"{}\" is not a number", escape_for_message(value)),
             "Write a plain decimal number, with a point and without quotes or units");
    return *number;
}

std::int64_t YamlValue::integer() const {
    const std::string& value = scalar("a whole number");
    const auto number = parse_integer(value);
    if (node_.Tag() == "!" || !number)
        fail(fmt::format("\"{}\" is not a whole number", escape_for_message(value)),
             "Write a whole number without quotes");
    return *number;
}

bool YamlValue::boolean() const {
    const std::string& value = scalar("true or false");
    if (node_.Tag() == "!" || (value != "true" && value != "false"))
        fail(fmt::format("\"{}\" is neither true nor false", escape_for_message(value)),
             "Write true or false");
    return value == "true";
}

std::vector<YamlValue> YamlValue::list() const {
    if (!exists()) return {};
    if (!node_.IsSequence())
        fail("is not a list", "Write a list: [a, b] or lines that begin with -");
    std::vector<YamlValue> items;
    for (std::size_t i = 0; i < node_.size(); ++i)
        items.emplace_back(node_[i], where_, fmt::format("{}[{}]", path_, i));
    return items;
}

std::vector<std::string> YamlValue::keys() const {
    std::vector<std::string> names;
    if (is_map())
        for (const auto& pair : node_)
            names.push_back(pair.first.Scalar());
    return names;
}

std::optional<double> YamlValue::optional_real() const {
    return exists() ? std::optional(real()) : std::nullopt;
}
std::optional<std::int64_t> YamlValue::optional_integer() const {
    return exists() ? std::optional(integer()) : std::nullopt;
}
std::optional<std::string> YamlValue::optional_text() const {
    return exists() ? std::optional(text()) : std::nullopt;
}

}  // namespace runcert
