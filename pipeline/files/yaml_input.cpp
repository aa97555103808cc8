#include "files/yaml_input.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include <set>
#include <sstream>

#include "core/failure.h"
#include "core/text.h"

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

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        enter(mark, "", anchor, "");
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_alias(mark); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        enter(mark, tag, anchor, value);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        enter(mark, tag, anchor, "");
        push(mark, false);
    }
    void OnSequenceEnd() override { levels_.pop_back(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
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
        if (!tag.empty() && tag != "?" && tag != "!" && !tag.starts_with("tag:yaml.org,2002:"))
            throw Failure(place(where_, mark), "the tag \"" + tag + "\" is not understood",
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
    [[noreturn]] void refuse_alias(const YAML::Mark& mark) {
        throw Failure(place(where_, mark), "YAML anchors and aliases are not read",
                      "Write the value out in each place");
    }

    const std::string& where_;
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

}  // namespace

YAML::Node parse_yaml(std::string_view text, const std::string& where) {
    refuse_other_encodings(text, where);
    try {
        std::istringstream stream{std::string(text)};
        YAML::Parser parser(stream);
        StrictEvents events(where);
        if (!parser.HandleNextDocument(events))
            throw Failure(where, "the file is empty", "Give the file its content back");
        StrictEvents rest(where);
        if (parser.HandleNextDocument(rest))
            throw Failure(where, "the file holds more than one YAML document",
                          "Keep one document, without further `---` lines");
        return YAML::Load(std::string(text));
    } catch (const YAML::Exception& error) {
        throw Failure(place(where, error.mark), "not valid YAML: " + error.msg,
                      "Check indentation, colons and quotes there");
    }
}

std::string yaml_place(const std::string& where, const YAML::Node& node) {
    if (!node.IsDefined()) return where;
    return place(where, node.Mark());
}

YamlValue::YamlValue(YAML::Node node, std::string where, std::string path)
    : node_(std::move(node)), where_(std::move(where)), path_(std::move(path)) {}

void YamlValue::fail(const std::string& what, const std::string& remedy) const {
    throw Failure(place(), path_.empty() ? what : path_ + ": " + what, remedy);
}

YamlValue YamlValue::operator[](const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (!is_map()) return {YAML::Node(YAML::NodeType::Undefined), where_, path};
    const YAML::Node& map = node_;
    return {map[key], where_, path};
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
