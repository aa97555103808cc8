#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <sstream>

#include "core/failure.h"
#include "core/text.h"
#include "files/yaml_parsers.h"

namespace runcert {
namespace {

std::string place(const std::string& where, const YAML::Mark& mark) {
    if (mark.is_null()) return where;
    return fmt::format("{}:{}:{}", where, mark.line + 1, mark.column + 1);
}

/// Builds a document from its events, and refuses what would make it large or ambiguous.
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
        builder_.null(built(mark));
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_alias(mark); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        enter(mark, tag, anchor, value);
        builder_.scalar(value, tag == "!", built(mark));
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        refuse_as_key(mark);
        enter(mark, tag, anchor, "");
        push(mark, false);
        builder_.begin(YamlKind::list, built(mark), tag == "tag:yaml.org,2002:omap");
    }
    void OnSequenceEnd() override { pop(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        refuse_as_key(mark);
        enter(mark, tag, anchor, "");
        push(mark, true);
        builder_.begin(YamlKind::map, built(mark));
    }
    void OnMapEnd() override { pop(); }

    /// The document; a null node where there is none.
    YamlNode document() && { return builder_.is_empty() ? YamlNode() : std::move(builder_).take(); }

  private:
    struct Level {
        bool is_map;
        bool key_next = true;
        std::set<std::string> keys{};
    };

    static YamlMark built(const YAML::Mark& mark) {
        if (mark.is_null()) return {};
        return {.line = mark.line, .column = mark.column};
    }
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
    void pop() {
        levels_.pop_back();
        builder_.end();
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
    YamlBuilder builder_;
};

}  // namespace

YamlNode parse_any_yaml(std::string_view text, const std::string& where) {
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
        YamlNode document = std::move(events).document();
        if (document.is_null())
            throw Failure(where, "the file is empty", "Give the file its content back");
        return document;
    } catch (const YAML::Exception& error) {
        const bool unclosed = error.msg == YAML::ErrorMsg::DOC_IN_SCALAR;
        throw Failure(place(where, error.mark),
                      "not valid YAML: " + (unclosed ? "a quote is not closed" : error.msg),
                      "Check indentation, colons and quotes there");
    }
}

}  // namespace runcert
