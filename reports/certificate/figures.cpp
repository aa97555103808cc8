#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_run.h"
#include "store/atomic_file.h"
#include "store/external_program.h"

namespace runcert {

std::string_view report_text(std::string_view name);

using Json = nlohmann::ordered_json;

namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Draws each point where it stands instead of referring to a shape by its id: WeasyPrint cannot
/// colour a shape that is referred to, and ids would be the same in all figures of a page.
void inline_points(std::string& svg) {
    struct Shape {
        std::string_view id, element, coloured;
    };
    static constexpr std::array<Shape, 4> shapes{
        {{"gpPt0", "path fill='none' stroke-width='0.3' d='M-1,0 h2 M0,-1 v2'", "stroke="},
         {"gpPt3", "rect fill='none' stroke-width='0.3' x='-1' y='-1' width='2' height='2'",
          "stroke="},
         {"gpPt5", "circle fill='none' stroke-width='0.4' r='1'", "stroke="},
         {"gpPt6", "circle stroke='none' r='1'", "fill="}}};
    if (const std::size_t defs = svg.find("<defs>"); defs != std::string::npos)
        svg.erase(defs, svg.find("</defs>") + 7 - defs);
    std::string out;
    std::size_t copied = 0;
    constexpr std::string_view reference = "<use xlink:href='#";
    for (std::size_t at = svg.find(reference); at != std::string::npos;
         at = svg.find(reference, copied)) {
        const std::size_t name = at + reference.size();
        const std::size_t quote = svg.find('\'', name);
        const std::size_t end = svg.find("/>", quote);
        const std::string id = svg.substr(name, quote - name);
        const auto shape = std::find_if(shapes.begin(), shapes.end(),
                                        [&](const Shape& known) { return known.id == id; });
        if (end == std::string::npos || shape == shapes.end())
            throw Failure("gnuplot", "a figure has points of an unknown shape " + id,
                          "Use gnuplot 5.4");
        std::string attributes = svg.substr(quote + 1, end - quote - 1);
        replace_all(attributes, "color=", shape->coloured);
        out += fmt::format("{}<{}{}", svg.substr(copied, at - copied), shape->element, attributes);
        copied = end;
    }
    svg = out + svg.substr(copied);
}

/// From the <svg> on, with the figure's own title.
std::string finished(std::string svg, const std::string& title) {
    svg.erase(0, svg.find("<svg"));
    inline_points(svg);
    if (const std::size_t desc = svg.find("<title>"); desc != std::string::npos)
        svg.replace(desc, svg.find("</desc>") + 7 - desc,
                    fmt::format("<title>{}</title>", kainjow::mustache::html_escape(title)));
    replace_all(svg, "font-family=\"DejaVu Sans\"",
                "font-family=\"DejaVu Sans, Verdana, sans-serif\"");
    return svg;
}

void run_gnuplot(const std::filesystem::path& folder) {
    const ExternalCall call{.command = {"gnuplot", "-d", "figures.gp"},
                            .folder = folder,
                            .environment = {{"GNUTERM", "svg"}}};
    const ProcessResult result = run_external(call);
    if (result.exit_status != 0)
        throw Failure(
            "gnuplot",
            fmt::format("the figures could not be drawn: {}", external_problem(call, result)),
            "Install the package gnuplot-nox again, or leave the figures out with --no-render");
}

}  // namespace

std::vector<std::string> draw_figures(const Json& predicate) {
    const Json& figures = predicate["figures"];
    if (figures.empty()) return {};
    const TemporaryFolder folder;
    const auto svg_of = [](std::size_t i) { return fmt::format("{}.svg", i); };
    std::string script(report_text("gnuplot/common.gp"));
    for (std::size_t i = 0; i < figures.size(); ++i)
        script += gnuplot_script(figures[i], svg_of(i));
    write_file_atomically(folder.path() / "figures.gp", script);
    run_gnuplot(folder.path());
    std::vector<std::string> drawn;
    for (std::size_t i = 0; i < figures.size(); ++i)
        drawn.push_back(finished(read_file(folder.path() / svg_of(i)),
                                 figures[i]["figure_title"].get<std::string>()));
    return drawn;
}

}  // namespace runcert
