// runcert-day-page FOLDER LIST: the page of a day of runs in that folder, with what a list of JSON
// says of each attempt, whatever it is; a real day has names that cannot be anything.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "reports/day/day_writing.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"

int main(int argc, char** argv) {
    using namespace runcert;
    namespace fs = std::filesystem;
    if (argc != 3) return 2;
    return guarded_main([&] {
        const fs::path folder = argv[1];
        const auto list = nlohmann::json::parse(read_file(argv[2]));
        Day day;
        day.name = list.at("day");
        std::vector<AttemptOutcome> outcomes;
        for (const auto& one : list.at("attempts")) {
            day.attempts.push_back({.id = one.at("id"), .source = one.at("source")});
            AttemptOutcome outcome{.state = one.at("state")};
            if (outcome.state == "failed")
                outcome.failure = RunFailure{.step = one.at("step"),
                                             .problem = one.at("problem"),
                                             .where = one.at("where"),
                                             .remedy = one.at("remedy")};
            outcome.reason = one.value("reason", "");
            if (outcome.state == "done") outcome.files["report.html"] = "";
            outcomes.push_back(std::move(outcome));
        }
        WindowCurves curves;
        DayResults results = results_of_day(day, outcomes, list.at("notes"), folder, curves);
        for (std::size_t i = 0; i < results.attempts.size(); ++i)
            for (const std::string note : list.at("attempts").at(i).at("notes"))
                results.attempts[i].notes.push_back(note);
        write_file_atomically(folder / "day.html", day_page(results, curves));
        return 0;
    });
}
