#include "reports/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <kainjow/mustache.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/process.h"
#include "files/sha256.h"

namespace runcert {

std::string_view report_text(std::string_view name);

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* trajectory_file = "4-trajectory.ecsv";
constexpr const char* screened_file = "3-screened.ecsv";

/// Nothing of a name that gnuplot could take for an instruction.
std::string plain_text(const std::string& text) {
    std::string plain;
    for (const char c : text.substr(0, 40)) {
        const bool harmless = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                              (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
        plain += harmless ? c : '?';
    }
    return plain;
}

std::string number(const Json& value) {
    return value.is_number() ? fmt::format("{}", value.get<double>()) : "NaN";
}

/// `array name[n] = [...]`; gnuplot has no empty arrays.
std::string array(const std::string& name, const std::vector<std::string>& values) {
    if (values.empty()) return fmt::format("array {}[1] = [NaN]\n", name);
    return fmt::format("array {}[{}] = [{}]\n", name, values.size(), fmt::join(values, ", "));
}

/// The beginnings and ends of the windows `which` ("window", "indicated") of all profiles, and of
/// those that make the figure together with them.
std::string window_arrays(const Json& predicate, const char* which, const std::string& prefix) {
    std::vector<std::string> starts, ends;
    const auto add = [&](const Json& window) {
        const double start = window["start_time_s"].get<double>();
        starts.push_back(fmt::format("{}", start));
        ends.push_back(fmt::format("{}", start + window["duration_s"].get<double>()));
    };
    for (const Json& profile : predicate["profiles"]) {
        if (!profile.contains(which)) continue;
        add(profile[which]);
        if (profile[which].contains("further"))
            for (const Json& further : profile[which]["further"])
                add(further);
    }
    return fmt::format("{}s = {}\n", prefix, starts.size()) + array(prefix + "_start", starts) +
           array(prefix + "_end", ends);
}

/// Figures are of the horizontal speed.
bool is_horizontal(const Json& profile) {
    return !profile.contains("rule_dimension");
}

std::string target_arrays(const Json& predicate) {
    std::vector<std::string> targets, titles;
    for (const Json& profile : predicate["profiles"]) {
        if (!profile.contains("target_km_h") || !is_horizontal(profile)) continue;
        targets.push_back(number(profile["target_km_h"]));
        titles.push_back(
            fmt::format("'speed to reach, {}'", plain_text(profile["profile"].get<std::string>())));
    }
    return fmt::format("targets = {}\n", targets.size()) + array("target", targets) +
           array("target_title", titles);
}

std::string run_settings(const Json& predicate, const Json& figure) {
    const Json& screening = predicate["receivers"][0]["screening"];
    return fmt::format(
               "every = {}\nunusable = {}\ngeoreferenced = {}\n", figure["every"].get<int>(),
               screening["epochs"].get<std::int64_t>() - screening["usable"].get<std::int64_t>(),
               predicate["frame"]["georeferenced"].get<bool>() ? 1 : 0) +
           window_arrays(predicate, "window", "window") +
           window_arrays(predicate, "indicated", "refused_window") + target_arrays(predicate);
}

std::string window_settings(const Json& predicate, const Json& figure) {
    for (const Json& profile : predicate["profiles"]) {
        if (profile["profile"] != figure["figure_profile"]) continue;
        const double start = profile["window"]["start_time_s"].get<double>();
        const auto level = [&](const char* name) {
            return number(is_horizontal(profile) ? profile.value(name, Json()) : Json());
        };
        return fmt::format("start = {}\nend = {}\nmean = {}\ntarget = {}\n", start,
                           start + profile["window"]["duration_s"].get<double>(),
                           level("speed_km_h"), level("target_km_h"));
    }
    throw Failure("report.json", "a figure is of a rule that the report does not hold",
                  "Run the attempt again");
}

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

/// From the <svg> on, with ids that are this figure's own, since one page holds several.
std::string embedded(std::string svg, const std::string& prefix, const std::string& title) {
    svg.erase(0, svg.find("<svg"));
    inline_points(svg);
    if (const std::size_t desc = svg.find("<title>"); desc != std::string::npos)
        svg.replace(desc, svg.find("</desc>") + 7 - desc,
                    fmt::format("<title>{}</title>", kainjow::mustache::html_escape(title)));
    replace_all(svg, "id=\"", "id=\"" + prefix + "-");
    replace_all(svg, "font-family=\"DejaVu Sans\"",
                "font-family=\"DejaVu Sans, Verdana, sans-serif\"");
    return svg;
}

std::string draw(const std::string& script, const std::filesystem::path& run_folder) {
    const TemporaryFolder folder;
    const std::filesystem::path script_file = folder.path() / "figure.gp";
    const std::filesystem::path svg_file = folder.path() / "figure.svg";
    write_file_atomically(script_file, script);
    const auto absolute = std::filesystem::absolute(run_folder);
    const ProcessResult result = run_process(
        {"gnuplot", "-d", "-c", script_file.string(), (absolute / trajectory_file).string(),
         (absolute / screened_file).string(), svg_file.string(), folder.path().string()},
        {{"LC_ALL", "C.UTF-8"}, {"GNUTERM", "svg"}, {"TZ", "UTC"}, {"GNUPLOT_FIT_SCRIPT", ""}});
    if (result.exit_status != 0 || !std::filesystem::exists(svg_file))
        throw Failure(
            "gnuplot",
            fmt::format("a figure could not be drawn (exit status {}): {}", result.exit_status,
                        escape_for_message(trim(result.errors), 2000)),
            "Install the package gnuplot-nox, or leave the figures out with --no-render");
    return read_file(svg_file);
}

void check_table(const std::filesystem::path& run_folder, const Json& predicate,
                 const std::string& file) {
    const std::filesystem::path path = run_folder / file;
    for (const Json& entry : predicate["files"])
        if (entry["file"] == file) {
            if (digest_file(path).sha256 == entry["sha256"].get<std::string>()) return;
            throw Failure(path.string(), "this is not the table that the report vouches for",
                          "Take the original, or run the attempt again");
        }
    throw Failure("report.json", fmt::format("the report does not vouch for {}", file),
                  "Run the attempt again");
}

}  // namespace

std::vector<DrawnFigure> draw_figures(const std::filesystem::path& run_folder,
                                      const Json& predicate) {
    std::vector<DrawnFigure> figures;
    for (const Json& figure : predicate["figures"]) {
        if (figures.empty()) {
            check_table(run_folder, predicate, trajectory_file);
            check_table(run_folder, predicate, screened_file);
        }
        const std::string kind = figure["figure"].get<std::string>();
        const std::string settings =
            kind == "window" ? window_settings(predicate, figure) : run_settings(predicate, figure);
        const std::string script = std::string(report_text("gnuplot/common.gp")) + settings +
                                   std::string(report_text(fmt::format("gnuplot/{}.gp", kind)));
        figures.push_back(
            {.title = figure["figure_title"].get<std::string>(),
             .caption = figure["caption"].get<std::string>(),
             .svg = embedded(draw(script, run_folder), fmt::format("figure{}", figures.size()),
                             figure["figure_title"].get<std::string>())});
    }
    return figures;
}

}  // namespace runcert
