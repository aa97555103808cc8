#include <algorithm>
#include <string>
#include <vector>

#include "run/stage_main.h"
#include "stages/import/attempt.h"
#include "stages/import/file_description.h"

using namespace runcert;

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (!words.empty() && (words[0] == "--describe" || words[0] == "--track"))
        return guarded_main([&] { return describe_main(words); });
    std::string folder;
    std::string earlier_run;
    return stage_main(
        argc, argv, "import",
        "Any supported recording to one table of WGS 84 positions in GPS time",
        [&](StageRun& run) {
            AttemptSource source{.file = run.attempt_path()};
            if (!folder.empty()) source.folder = folder;
            if (!earlier_run.empty()) source.earlier_run = earlier_run;
            import_attempt(run, source);
        },
        [&](CommandLine& line) {
            line.text("--folder", folder,
                      "folder that what the attempt names is relative to and must be inside "
                      "of (default: the attempt's)");
            line.text("--earlier-run", earlier_run,
                      "take recordings and profiles from this run folder's copies instead of "
                      "where the attempt says");
        });
}
