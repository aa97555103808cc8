#include "store/pattern.h"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>

#include "core/failure.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view wildcards = "*?";

/// A part of a pattern: characters as they are, or adjacent wildcards.
struct Piece {
    std::string_view text;
    bool wildcard = false;

    std::size_t shortest() const {
        return wildcard ? static_cast<std::size_t>(std::count(text.begin(), text.end(), '?'))
                        : text.size();
    }
    bool any_length() const { return wildcard && text.find('*') != std::string_view::npos; }
};

std::vector<Piece> pieces_of(std::string_view pattern) {
    std::vector<Piece> pieces;
    while (!pattern.empty()) {
        const bool wildcard = wildcards.find(pattern.front()) != std::string_view::npos;
        const std::size_t end =
            wildcard ? pattern.find_first_not_of(wildcards) : pattern.find_first_of(wildcards);
        pieces.push_back({pattern.substr(0, end), wildcard});
        pattern.remove_prefix(std::min(end, pattern.size()));
    }
    return pieces;
}

/// Where the last characters of a name are matched by the last pieces of a pattern:
/// `[piece][first character]`. A table, because trying is exponential in the number of pieces.
using Reach = std::vector<std::vector<char>>;

Reach reach_of(const std::vector<Piece>& pieces, std::string_view name) {
    Reach reach(pieces.size() + 1, std::vector<char>(name.size() + 1, 0));
    reach.back().back() = 1;
    for (std::size_t p = pieces.size(); p-- > 0;) {
        const Piece& piece = pieces[p];
        bool later = false;  // whether the rest matches this far or further on
        for (std::size_t at = name.size() + 1; at-- > 0;) {
            const std::size_t end = at + piece.shortest();
            if (end > name.size()) continue;
            later = later || reach[p + 1][end];
            const bool rest = piece.any_length() ? later : reach[p + 1][end] != 0;
            reach[p][at] = rest && (piece.wildcard || name.substr(at).starts_with(piece.text));
        }
    }
    return reach;
}

/// What each wildcard of a pattern stands for in a name; nothing where it does not match.
std::optional<std::vector<std::string>> match(std::string_view pattern, std::string_view name) {
    const std::vector<Piece> pieces = pieces_of(pattern);
    const Reach reach = reach_of(pieces, name);
    if (!reach[0][0]) return std::nullopt;
    std::vector<std::string> stood_for;
    std::size_t at = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        std::size_t end = at + pieces[p].shortest();
        while (!reach[p + 1][end])
            ++end;
        if (pieces[p].wildcard) stood_for.emplace_back(name.substr(at, end - at));
        at = end;
    }
    return stood_for;
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::error_code error;
    std::vector<std::string> names;
    fs::directory_iterator entry(folder, error);
    for (; !error && entry != fs::directory_iterator(); entry.increment(error))
        names.push_back(entry->path().filename().string());
    if (error && error.value() != ENOENT && error.value() != ENOTDIR)
        throw Failure(folder.string(), "the folder cannot be read: " + error.message(),
                      "Allow it to be read");
    return names;
}

/// Adds what a pattern's first part and then the rest of it match in a folder.
void add_matches(const fs::path& root, const PatternMatch& so_far, std::string_view pattern,
                 std::vector<PatternMatch>& matches) {
    const std::size_t slash = pattern.find('/');
    const std::string_view part = pattern.substr(0, slash);
    const bool last = slash == std::string_view::npos;
    const auto step = [&](const std::string& name, const std::vector<std::string>& stood_for) {
        PatternMatch next = so_far;
        next.file += name;
        next.stood_for.insert(next.stood_for.end(), stood_for.begin(), stood_for.end());
        std::error_code error;
        if (!last) {
            next.file += '/';
            add_matches(root, next, pattern.substr(slash + 1), matches);
        } else if (fs::is_regular_file(root / next.file, error)) {
            matches.push_back(std::move(next));
        }
    };
    if (!is_pattern(part)) return step(std::string(part), {});
    for (const std::string& name : names_in(so_far.file.empty() ? root : root / so_far.file)) {
        if (name.starts_with('.') && !part.starts_with('.')) continue;
        if (const auto stood_for = match(part, name)) step(name, *stood_for);
    }
}

}  // namespace

bool is_pattern(std::string_view name) {
    return name.find_first_of(wildcards) != std::string_view::npos;
}

bool matches_pattern(std::string_view text, std::string_view pattern) {
    return match(pattern, text).has_value();
}

bool matches_pattern_list(std::string_view text, std::string_view patterns) {
    bool matches = false;
    while (!patterns.empty()) {
        std::string_view pattern = patterns.substr(0, patterns.find(','));
        patterns.remove_prefix(std::min(pattern.size() + 1, patterns.size()));
        const bool negated = pattern.starts_with('!');
        if (negated) pattern.remove_prefix(1);
        if (!matches_pattern(text, pattern)) continue;
        if (negated) return false;
        matches = true;
    }
    return matches;
}

std::vector<PatternMatch> matching_files(const fs::path& folder, const std::string& pattern) {
    std::vector<PatternMatch> matches;
    add_matches(folder, {}, pattern, matches);
    std::sort(matches.begin(), matches.end(),
              [](const PatternMatch& a, const PatternMatch& b) { return a.file < b.file; });
    return matches;
}

std::size_t wildcard_count(std::string_view pattern) {
    const std::vector<Piece> pieces = pieces_of(pattern);
    return static_cast<std::size_t>(std::count_if(
        pieces.begin(), pieces.end(), [](const Piece& piece) { return piece.wildcard; }));
}

std::string filled_in(std::string_view pattern, const std::vector<std::string>& stood_for) {
    std::string text;
    std::size_t used = 0;
    for (const Piece& piece : pieces_of(pattern))
        text += piece.wildcard ? stood_for.at(used++) : std::string(piece.text);
    return text;
}

}  // namespace runcert
