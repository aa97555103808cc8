// A program of the build: `runcert_embed_yaml FILE FUNCTION SOURCE` parses a YAML file and writes a
// C++ source that defines `YamlNode FUNCTION()`, the root of that document.

#include <fmt/format.h>

#include <exception>

#include "store/atomic_file.h"
#include "store/yaml_input.h"

namespace runcert {
namespace {

std::string literal(std::string_view text) {
    std::string quoted;
    // Compilers limit the length of one literal; neighbours are joined.
    constexpr std::size_t longest = 1000;
    for (std::size_t at = 0; at < text.size(); at += longest) {
        quoted += "\n    \"";
        for (const char c : text.substr(at, longest))
            quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
        quoted += '"';
    }
    return quoted.empty() ? "\"\"" : quoted;
}

std::string source_of(const YamlNode& root, const std::string& function) {
    YamlBuilder builder;
    builder.copy(root);
    std::string entries;
    for (const YamlEntry& entry : builder.entries())
        entries += fmt::format("    {{{{{}, {}}}, {}, {}, YamlKind{{{}}}, {}, {}}},\n",
                               entry.mark.line, entry.mark.column, entry.begin, entry.count,
                               static_cast<int>(entry.kind), entry.is_quoted, entry.is_ordered_map);
    return fmt::format(
        "#include \"store/yaml_node.h\"\n"
        "namespace runcert {{\n"
        "namespace {{\n"
        "constexpr YamlEntry entries[] = {{\n{}}};\n"
        "constexpr std::string_view texts(\n    {}, {});\n"
        "constexpr YamlDocument document{{entries, texts}};\n"
        "}}  // namespace\n"
        "YamlNode {}();\n"
        "YamlNode {}() {{ return YamlNode(document); }}\n"
        "}}  // namespace runcert\n",
        entries, literal(builder.texts()), builder.texts().size(), function, function);
}

}  // namespace
}  // namespace runcert

int main(int argc, char** argv) {
    try {
        if (argc != 4) throw std::invalid_argument("expected FILE FUNCTION SOURCE");
        const std::string text = runcert::read_file(argv[1]);
        runcert::write_if_changed(argv[3],
                                  runcert::source_of(runcert::parse_yaml(text, argv[1]), argv[2]));
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "runcert_embed_yaml: {}\n", error.what());
        return 1;
    }
}
